/* plugin_oiio.cpp - terraclip-oiio.so: pictures through OpenImageIO, behind extern "C".
 *
 * Samples are read in their own type: reading integers as float would map them to 0..1. Rows are read one at a time
 * where the format is row-wise: a read of many rows at once can report success for a truncated file. Loading
 * OpenImageIO takes a quarter of a second and more than 100 MB, which is why it is a plugin of its own and the last
 * to be tried. */
#include "plugin_tables.h"

extern "C" {
#include "common/base/status.h"
}

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <vector>

#include <sys/stat.h>

namespace
{

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

/* A picture from the top down: a row, or a row of tiles, at a time. */
struct oiio_input {
    std::unique_ptr<OIIO::ImageInput> file;
    OIIO::TypeDesc type;              /* of samples as they are given */
    std::vector<unsigned char> bytes; /* one row or one row of tiles, all channels */
    int64_t tile_row = -1;            /* which row of tiles it holds */

    const OIIO::ImageSpec &spec() const { return file->spec(); }

    size_t row_bytes() const { return (size_t)spec().width * spec().nchannels * type.size(); }

    void begin() /* with file and type */
    {
        bytes.resize(row_bytes() * (spec().tile_height > 0 ? (size_t)spec().tile_height : 1));
    }

    /* Row y (from the top) of all channels; NULL on failure. */
    const unsigned char *fetch(int64_t y)
    {
        const OIIO::ImageSpec &s = spec();
        if (s.tile_width == 0) {
            int at = s.y + (int)y;
            return file->read_scanlines(0, 0, at, at + 1, 0, 0, s.nchannels, type, bytes.data()) ? bytes.data()
                                                                                                 : nullptr;
        }
        int64_t row = y / s.tile_height;
        if (row != tile_row) {
            int top = s.y + (int)(row * s.tile_height);
            int bottom = std::min(top + s.tile_height, s.y + s.height);
            tile_row = -1;
            if (!file->read_tiles(0, 0, s.x, s.x + s.width, top, bottom, s.z, s.z + 1, 0, s.nchannels, type,
                                  bytes.data()))
                return nullptr;
            tile_row = row;
        }
        return bytes.data() + (size_t)(y - row * s.tile_height) * row_bytes();
    }
};

struct oiio_raster {
    tc_raster base; /* first: a tc_raster pointer is one to this */
    std::string path;
    oiio_input input;
    int alpha; /* channel that serves as mask, or -1 */
};

oiio_raster *self(tc_raster *raster)
{
    return reinterpret_cast<oiio_raster *>(raster);
}

/* OpenImageIO's message without its line ends. */
std::string one_line(std::string text)
{
    while (!text.empty() && (text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ',');
    return text.empty() ? "OpenImageIO gives no reason" : text;
}

bool choose_type(oiio_raster *r)
{
    const OIIO::ImageSpec &spec = r->input.spec();
    tc_raster_info &info = r->base.info;
    r->input.type = OIIO::TypeDesc((OIIO::TypeDesc::BASETYPE)spec.format.basetype);
    info.integer = true;
    switch (spec.format.basetype) {
    case OIIO::TypeDesc::UINT8:
        info.type = TC_SAMPLE_UINT8;
        info.type_name = "uint8";
        return true;
    case OIIO::TypeDesc::INT8:
        info.type = TC_SAMPLE_INT8;
        info.type_name = "int8";
        return true;
    case OIIO::TypeDesc::UINT16:
        info.type = TC_SAMPLE_UINT16;
        info.type_name = "uint16";
        return true;
    case OIIO::TypeDesc::INT16:
        info.type = TC_SAMPLE_INT16;
        info.type_name = "int16";
        return true;
    case OIIO::TypeDesc::UINT32:
        info.type = TC_SAMPLE_UINT32;
        info.type_name = "uint32";
        return true;
    case OIIO::TypeDesc::INT32:
        info.type = TC_SAMPLE_INT32;
        info.type_name = "int32";
        return true;
    default: break;
    }
    info.integer = false;
    switch (spec.format.basetype) {
    case OIIO::TypeDesc::HALF:
        info.type = TC_SAMPLE_FLOAT32;
        info.type_name = "float16";
        r->input.type = OIIO::TypeFloat; /* half to float is exact and not rescaled */
        return true;
    case OIIO::TypeDesc::FLOAT:
        info.type = TC_SAMPLE_FLOAT32;
        info.type_name = "float32";
        return true;
    case OIIO::TypeDesc::DOUBLE:
        info.type = TC_SAMPLE_FLOAT64;
        info.type_name = "float64";
        return true;
    default: return false;
    }
}

tc_status read_rows(tc_raster *raster, int64_t row, int64_t rows, void *samples, uint8_t *mask, tc_error *error)
{
    oiio_raster *r = self(raster);
    const OIIO::ImageSpec &spec = r->input.spec();
    size_t size = r->input.type.size(), channels = (size_t)spec.nchannels;
    try {
        for (int64_t k = 0; k < rows; k++) {
            const unsigned char *from = r->input.fetch(row + k);
            if (!from)
                return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read to its end, damaged or truncated: %s",
                               r->path.c_str(), one_line(r->input.file->geterror()).c_str());
            unsigned char *to = (unsigned char *)samples + (size_t)k * spec.width * size;
            if (channels == 1) {
                std::memcpy(to, from, spec.width * size);
                continue;
            }
            static const unsigned char zero[8] = {0};
            for (int i = 0; i < spec.width; i++) {
                std::memcpy(to + i * size, from + (i * channels + (1 - r->alpha)) * size, size);
                mask[k * spec.width + i] = std::memcmp(from + (i * channels + r->alpha) * size, zero, size) != 0;
            }
        }
    } catch (const std::exception &failure) {
        return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read: %s", r->path.c_str(),
                       one_line(failure.what()).c_str());
    }
    return TC_OK;
}

void close_raster(tc_raster *raster)
{
    delete self(raster);
}

/* What is no picture at all, or not all of one. */
tc_status check_whole(const char *path, const OIIO::ImageSpec &spec, tc_error *error)
{
    if (spec.deep || spec.depth > 1 || spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected a flat picture, found a deep or empty one", path);
    /* OpenEXR reads an uncompressed row that is too short for the claimed width without complaint. */
    struct stat about;
    double bytes = (double)spec.width * spec.height * spec.nchannels * spec.format.size();
    if (spec.get_string_attribute("compression") == "none" && stat(path, &about) == 0 && (double)about.st_size < bytes)
        return tc_fail(error, TC_ERR_FORMAT, "%s: damaged or truncated: expected at least %.0f bytes, found %lld", path,
                       bytes, (long long)about.st_size);
    return TC_OK;
}

/* Tells what a file says of whose it is. */
void tell_credit(const OIIO::ImageSpec &spec, const tc_source_options *options)
{
    std::string text;
    if (!options || !options->credit)
        return;
    for (const char *item : {"Copyright", "Artist"})
        text = text.empty() ? std::string(spec.get_string_attribute(item)) : text;
    if (!text.empty())
        options->credit(options->credit_context, text.c_str());
}

tc_status describe(oiio_raster *r, const tc_source_options *options, tc_error *error)
{
    const OIIO::ImageSpec &spec = r->input.spec();
    const char *path = r->path.c_str();
    tc_status status = check_whole(path, spec, error);
    if (status != TC_OK)
        return status;
    if (spec.nchannels > 2)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected one channel of heights, found %s channels: %s", path,
                       spec.nchannels == 3 ? "three" : "more than three", tc_channels_advice());
    r->alpha = spec.nchannels == 2 ? spec.alpha_channel : -1;
    if (spec.nchannels == 2 && r->alpha < 0)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected one channel of heights, found two of which the second is no mask", path);
    if (!choose_type(r))
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected real numbers, found samples of type %s", path,
                       spec.format.c_str());
    tc_raster_info &info = r->base.info;
    info.width = spec.width;
    info.height = spec.height;
    info.block_rows = spec.tile_height > 0 ? spec.tile_height : 1;
    info.has_mask = r->alpha >= 0;
    info.scale = 1;
    r->input.begin();
    tell_credit(spec, options);
    if (options->say && r->input.file->seek_subimage(1, 0)) {
        options->say(options->say_context, true, "the file holds several pictures; the first is shown");
        r->input.file->seek_subimage(0, 0);
    }
    return TC_OK;
}

tc_status open_raster(const char *path, const tc_source_options *options, bool *recognised, tc_raster **raster_ret,
                      tc_error *error)
{
    *recognised = false;
    try {
        auto r = std::make_unique<oiio_raster>();
        r->base = tc_raster();
        r->base.read = read_rows;
        r->base.close = close_raster;
        r->path = path;
        OIIO::ImageSpec wish;
        wish.attribute("oiio:UnassociatedAlpha", 1); /* heights must not come multiplied by their mask */
        r->input.file = OIIO::ImageInput::open(path, &wish);
        if (!r->input.file)
            return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: cannot be opened as a picture: %s", path,
                           one_line(OIIO::geterror()).c_str());
        *recognised = true;
        tc_status status = describe(r.get(), options, error);
        if (status == TC_OK)
            *raster_ret = &r.release()->base;
        return status;
    } catch (const std::bad_alloc &) {
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
    } catch (const std::exception &failure) {
        return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be opened: %s", path, one_line(failure.what()).c_str());
    }
}

/* ---- Pictures ---------------------------------------------------------------------------------------------------- */

/* Rows of colours: what is stored, as it is shown. */
struct oiio_rows {
    tc_image_rows base; /* first: a tc_image_rows pointer is one to this */
    std::string path;
    oiio_input input; /* as float, 0 .. 1 */
    bool light;       /* floats are light, not what is shown */
    bool multiplied;  /* colours are, by alpha */
};

uint8_t shown(float value, bool light)
{
    double c = value > 0 ? std::min(value, 1.0f) : 0; /* also what is no number */
    if (light)
        c = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    return (uint8_t)(c * 255 + 0.5);
}

tc_status read_colours(tc_image_rows *rows, int64_t row, int64_t count, uint8_t (*rgba)[4], tc_error *error)
{
    oiio_rows *r = reinterpret_cast<oiio_rows *>(rows);
    const OIIO::ImageSpec &spec = r->input.spec();
    const int colours = spec.nchannels - (spec.alpha_channel >= 0);
    try {
        for (int64_t k = 0; k < count; k++) {
            const float *from = reinterpret_cast<const float *>(r->input.fetch(row + k));
            if (!from)
                return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read to its end, damaged or truncated: %s",
                               r->path.c_str(), one_line(r->input.file->geterror()).c_str());
            for (int i = 0; i < spec.width; i++, from += spec.nchannels) {
                uint8_t *to = rgba[k * spec.width + i];
                float alpha = spec.alpha_channel >= 0 ? from[spec.alpha_channel] : 1;
                float whole = r->multiplied && alpha > 0 ? alpha : 1;
                for (int c = 0; c < 3; c++)
                    to[c] = shown(from[colours >= 3 ? c : 0] / whole, r->light);
                to[3] = shown(alpha, false);
            }
        }
    } catch (const std::exception &failure) {
        return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read: %s", r->path.c_str(),
                       one_line(failure.what()).c_str());
    }
    return TC_OK;
}

void close_rows(tc_image_rows *rows)
{
    delete reinterpret_cast<oiio_rows *>(rows);
}

tc_status open_rows(const char *path, const tc_image_options *options, tc_image_rows **rows_ret, tc_error *error)
{
    try {
        auto r = std::make_unique<oiio_rows>();
        r->base = tc_image_rows();
        r->path = path;
        OIIO::ImageSpec wish;
        wish.attribute("oiio:UnassociatedAlpha", 1);
        r->input.file = OIIO::ImageInput::open(path, &wish);
        if (!r->input.file)
            return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: cannot be opened as a picture: %s", path,
                           one_line(OIIO::geterror()).c_str());
        const OIIO::ImageSpec &spec = r->input.spec();
        tc_status status = check_whole(path, spec, error);
        if (status != TC_OK)
            return status;
        r->multiplied = spec.alpha_channel >= 0 && !spec.get_int_attribute("oiio:UnassociatedAlpha");
        r->light = spec.format.is_floating_point() && spec.get_string_attribute("oiio:ColorSpace") != "sRGB";
        if (r->light && options->source->say)
            options->source->say(options->source->say_context, false,
                                 "floats are taken for light: 0 is black, 1 and above white");
        r->input.type = OIIO::TypeFloat;
        r->input.begin();
        tell_credit(spec, options->source);
        r->base.name = r->path.c_str();
        r->base.width = spec.width;
        r->base.height = spec.height;
        r->base.read = read_colours;
        r->base.close = close_rows;
        *rows_ret = &r.release()->base;
        return TC_OK;
    } catch (const std::bad_alloc &) {
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
    } catch (const std::exception &failure) {
        return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be opened: %s", path, one_line(failure.what()).c_str());
    }
}

/* ---- Writing ---------------------------------------------------------------------------------------------------- */

bool can_write(const char *path)
{
    bool known = OIIO::ImageOutput::create(path) != nullptr;
    OIIO::geterror(); /* forget its message */
    return known;
}

tc_status write_picture(const char *path, const char *temporary, int width, int height, const uint8_t *rgb,
                        tc_error *error)
{
    try {
        auto output = OIIO::ImageOutput::create(temporary);
        if (!output)
            return tc_fail(error, TC_ERR_USAGE,
                           "%s: expected a picture format by its extension, found none that is known", path);
        OIIO::ImageSpec spec(width, height, 3, OIIO::TypeUInt8);
        spec.attribute("png:compressionLevel", 4); /* a third of the time of the default, a few per cent larger */
        bool done = output->open(temporary, spec) && output->write_image(OIIO::TypeUInt8, rgb);
        done = output->close() && done; /* closed in any case: the last bytes are written here */
        if (!done)
            return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, one_line(output->geterror()).c_str());
        return TC_OK;
    } catch (const std::exception &failure) {
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, one_line(failure.what()).c_str());
    }
}

} // namespace

extern "C" {
extern const struct tc_oiio_plugin tc_plugin __attribute__((visibility("default"))); /* found by this name */
const struct tc_oiio_plugin tc_plugin = {open_raster, open_rows, write_picture, can_write};
}
