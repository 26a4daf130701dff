/* plugin_video.c - video.h by means of libavformat, libavcodec and libswscale. Becomes terraclip-video.so, so that only
 * programs that make a film load them. */
#include "video.h"
#include "common/base/status.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>

#include <stdlib.h>
#include <string.h>
#include <strings.h>

extern const struct tc_video_plugin tc_plugin __attribute__((visibility("default"))); /* found by this name */

struct tc_video {
    char *path, *name; /* owned: where it is written, and what is told of */
    AVFormatContext *file;
    AVCodecContext *coder;
    AVStream *stream;
    AVFrame *frame;
    AVPacket *packet;
    struct SwsContext *colours;
    int row_bytes; /* of a picture that comes in */
    int64_t count;
    bool headed; /* its head is written */
};

/* What is tried for an ending, in this order, each with options of its own: near to lossless for the eye. */
static const struct encoder {
    const char *ending, *name;
    const char *options[4][2];
} encoders[] = {
    {".mp4", "libx264", {{"crf", "17"}, {"preset", "medium"}}},
    {".mp4", "mpeg4", {{"qmin", "2"}, {"qmax", "4"}}},
    {".webm", "libvpx-vp9", {{"crf", "20"}, {"deadline", "good"}, {"cpu-used", "4"}, {"row-mt", "1"}}},
    {".webm", "libvpx", {{"crf", "8"}, {"deadline", "good"}, {"cpu-used", "4"}}},
};

static tc_status fail(const tc_video *v, tc_error *error, tc_status status, const char *what, int code)
{
    char reason[AV_ERROR_MAX_STRING_SIZE];
    if (code == AVERROR(ENOMEM))
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", v->name);
    av_strerror(code, reason, sizeof reason);
    return tc_fail(error, status, "%s: %s: %s", v->name, what, reason);
}

/* ---- Beginning --------------------------------------------------------------------------------------------------- */

/* Opens an encoder; NULL where it is not there or does not want to. */
static AVCodecContext *open_encoder(const struct encoder *e, int width, int height, int rate, bool head)
{
    const AVCodec *codec = avcodec_find_encoder_by_name(e->name);
    AVCodecContext *coder = codec ? avcodec_alloc_context3(codec) : NULL;
    if (!coder)
        return NULL;
    coder->width = width, coder->height = height;
    coder->time_base = (AVRational){1, rate};
    coder->framerate = (AVRational){rate, 1};
    coder->gop_size = 2 * rate;
    coder->pix_fmt = AV_PIX_FMT_YUV420P;
    coder->color_range = AVCOL_RANGE_MPEG;
    coder->colorspace = AVCOL_SPC_BT709;
    coder->color_primaries = AVCOL_PRI_BT709;
    coder->color_trc = AVCOL_TRC_BT709;
    coder->bit_rate = strcmp(e->name, "libvpx") == 0 ? 40000000 : 0; /* its most; others follow their quality alone */
    if (head)
        coder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    for (int i = 0; i < 4 && e->options[i][0]; i++)
        av_opt_set(coder, e->options[i][0], e->options[i][1], AV_OPT_SEARCH_CHILDREN);
    if (avcodec_open2(coder, codec, NULL) < 0)
        avcodec_free_context(&coder);
    return coder;
}

static tc_status begin_coder(tc_video *v, const char *ending, int width, int height, int rate, tc_error *error)
{
    bool head = v->file->oformat->flags & AVFMT_GLOBALHEADER;
    for (size_t i = 0; i < sizeof encoders / sizeof *encoders && !v->coder; i++)
        if (strcasecmp(encoders[i].ending, ending) == 0)
            v->coder = open_encoder(&encoders[i], width, height, rate, head);
    if (!v->coder)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: the installed ffmpeg libraries have no encoder for %d x %d in %s", v->name, width, height,
                       ending + 1);
    v->stream = avformat_new_stream(v->file, NULL);
    v->frame = av_frame_alloc();
    v->packet = av_packet_alloc();
    if (!v->stream || !v->frame || !v->packet)
        return fail(v, error, TC_ERR_MEMORY, "", AVERROR(ENOMEM));
    v->stream->time_base = v->coder->time_base;
    v->stream->avg_frame_rate = v->coder->framerate;
    v->frame->format = v->coder->pix_fmt;
    v->frame->width = width, v->frame->height = height;
    v->frame->color_range = v->coder->color_range;
    v->frame->colorspace = v->coder->colorspace;
    int code = avcodec_parameters_from_context(v->stream->codecpar, v->coder);
    if (code >= 0)
        code = av_frame_get_buffer(v->frame, 0);
    return code < 0 ? fail(v, error, TC_ERR_MEMORY, "cannot be begun", code) : TC_OK;
}

/* From pictures, whose numbers are all of 0 .. 255, to BT.709's 16 .. 235. */
static tc_status begin_colours(tc_video *v, tc_error *error)
{
    int width = v->coder->width, height = v->coder->height;
    v->colours = sws_getContext(width, height, AV_PIX_FMT_RGB24, width, height, AV_PIX_FMT_YUV420P,
                                SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT, NULL, NULL, NULL);
    const int *table = sws_getCoefficients(SWS_CS_ITU709);
    if (!v->colours || sws_setColorspaceDetails(v->colours, table, 1, table, 0, 0, 1 << 16, 1 << 16) < 0)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: the installed ffmpeg libraries cannot convert colours", v->name);
    return TC_OK;
}

static tc_status open_file(tc_video *v, tc_error *error)
{
    int code = avio_open(&v->file->pb, v->path, AVIO_FLAG_WRITE);
    if (code < 0)
        return fail(v, error, TC_ERR_IO, "cannot be written", code);
    code = avformat_write_header(v->file, NULL);
    if (code < 0)
        return fail(v, error, TC_ERR_IO, "cannot be written", code);
    v->headed = true;
    return TC_OK;
}

static void free_video(tc_video *v)
{
    sws_freeContext(v->colours);
    av_packet_free(&v->packet);
    av_frame_free(&v->frame);
    avcodec_free_context(&v->coder);
    if (v->file)
        avio_closep(&v->file->pb);
    avformat_free_context(v->file);
    free(v->path);
    free(v->name);
    free(v);
}

static tc_status video_begin(const char *path, const char *name, int width, int height, int rate, tc_video **video_ret,
                             tc_error *error)
{
    const char *ending = strrchr(path, '.');
    tc_video *v = calloc(1, sizeof *v);
    av_log_set_level(AV_LOG_QUIET);                   /* errors are returned */
    if (v && asprintf(&v->path, "file:%s", path) < 0) /* whatever colons there are */
        v->path = NULL;
    if (!v || !v->path || !(v->name = strdup(name))) {
        if (v)
            free(v->path);
        free(v);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    v->row_bytes = 3 * width;
    int code = avformat_alloc_output_context2(&v->file, NULL, ending ? ending + 1 : "", path);
    tc_status status = code < 0 ? fail(v, error, TC_ERR_UNSUPPORTED, "no such film can be made", code) : TC_OK;
    if (status == TC_OK && (width < 2 || height < 2))
        status = tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected at least 2 x 2 pixels, found %d x %d", name, width,
                         height);
    if (status == TC_OK)
        status = begin_coder(v, ending, width & ~1, height & ~1, rate, error);
    if (status == TC_OK)
        status = begin_colours(v, error);
    if (status == TC_OK)
        status = open_file(v, error);
    if (status != TC_OK)
        free_video(v);
    else
        *video_ret = v;
    return status;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Codes a frame, or at the end (NULL) what is left, and writes what comes of it. */
static tc_status code_frame(tc_video *v, const AVFrame *frame, tc_error *error)
{
    int code = avcodec_send_frame(v->coder, frame);
    while (code >= 0) {
        code = avcodec_receive_packet(v->coder, v->packet);
        if (code == AVERROR(EAGAIN) || code == AVERROR_EOF)
            return TC_OK;
        if (code < 0)
            break;
        v->packet->stream_index = v->stream->index;
        v->packet->duration = 1;
        av_packet_rescale_ts(v->packet, v->coder->time_base, v->stream->time_base);
        code = av_interleaved_write_frame(v->file, v->packet);
    }
    return fail(v, error, TC_ERR_IO, "cannot be written", code);
}

static tc_status video_add(tc_video *v, const uint8_t *rgb, tc_error *error)
{
    int code = av_frame_make_writable(v->frame);
    if (code < 0)
        return fail(v, error, TC_ERR_MEMORY, "cannot be written", code);
    sws_scale(v->colours, (const uint8_t *const[]){rgb}, (const int[]){v->row_bytes}, 0, v->coder->height,
              v->frame->data, v->frame->linesize);
    v->frame->pts = v->count++;
    return code_frame(v, v->frame, error);
}

static tc_status video_end(tc_video *v, tc_status status, tc_error *error)
{
    if (!v)
        return status;
    if (status == TC_OK)
        status = code_frame(v, NULL, error);
    if (v->headed) {
        int code = av_write_trailer(v->file);
        if (code >= 0)
            code = avio_closep(&v->file->pb);
        if (code < 0 && status == TC_OK)
            status = fail(v, error, TC_ERR_IO, "cannot be written", code);
    }
    free_video(v);
    return status;
}

const struct tc_video_plugin tc_plugin = {.begin = video_begin, .add = video_add, .end = video_end};
