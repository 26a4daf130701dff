/* credits.c - whose data are shown; see credits.h. */
#include "credits.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const char OTHERS[] = "... and others";

/* The next character, and how many bytes it takes: 1 where they are no UTF-8. */
static uint32_t next(const unsigned char *text, size_t *bytes_ret)
{
    static const struct {
        unsigned char mask, lead;
        uint32_t least; /* that is not written shorter */
    } forms[] = {{0x80, 0, 0}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}};
    *bytes_ret = 1;
    for (size_t more = 0; more < sizeof forms / sizeof *forms; more++) {
        if ((text[0] & forms[more].mask) != forms[more].lead)
            continue;
        uint32_t character = text[0] & (unsigned char)~forms[more].mask;
        for (size_t k = 1; k <= more; k++) {
            if ((text[k] & 0xc0) != 0x80) /* also at the text's end */
                return text[0];
            character = character << 6 | (text[k] & 0x3f);
        }
        if (character < forms[more].least || character > 0x10ffff || (character >= 0xd800 && character <= 0xdfff))
            return text[0];
        *bytes_ret = more + 1;
        return character;
    }
    return text[0];
}

/* Control characters, spaces, and signs that turn the direction of others or are not seen, as far as they are common.
 */
static bool is_blank(uint32_t c)
{
    static const struct {
        uint32_t first, last;
    } blank[] = {{0, 0x20},        {0x7f, 0xa0},     {0xad, 0xad},       {0x61c, 0x61c},   {0x115f, 0x1160},
                 {0x1680, 0x1680}, {0x180e, 0x180e}, {0x2000, 0x200f},   {0x2028, 0x202f}, {0x205f, 0x206f},
                 {0x2800, 0x2800}, {0x3000, 0x3000}, {0x3164, 0x3164},   {0xe000, 0xf8ff}, {0xfeff, 0xfeff},
                 {0xffa0, 0xffa0}, {0xfff0, 0xffff}, {0xe0000, 0x10ffff}};
    bool is = false;
    for (size_t k = 0; k < sizeof blank / sizeof *blank; k++)
        is |= c >= blank[k].first && c <= blank[k].last;
    return is;
}

static size_t put(uint32_t c, char *to)
{
    if (c < 0x80) {
        to[0] = (char)c;
        return 1;
    }
    const size_t more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    static const unsigned char lead[] = {0, 0xc0, 0xe0, 0xf0};
    to[0] = (char)(lead[more] | c >> (6 * more));
    for (size_t k = 1; k <= more; k++)
        to[k] = (char)(0x80 | (c >> (6 * (more - k)) & 0x3f));
    return more + 1;
}

static void clean(const char *text, char line[TC_CREDIT_LENGTH])
{
    enum { WIDEST = 4, DOTS = 4 /* " ..." */ };
    const unsigned char *from = (const unsigned char *)text;
    size_t length = 0, bytes;
    bool space = false;
    for (; *from; from += bytes) {
        const uint32_t c = next(from, &bytes);
        if (is_blank(c)) {
            space = length > 0;
            continue;
        }
        if (length + 1 + WIDEST + DOTS >= TC_CREDIT_LENGTH) {
            length += (size_t)snprintf(line + length, TC_CREDIT_LENGTH - length, " ...");
            break;
        }
        if (space)
            line[length++] = ' ';
        space = false;
        length += put(c, line + length);
    }
    line[length] = '\0';
}

void tc_credits_add(tc_credits *credits, const char *text)
{
    char line[TC_CREDIT_LENGTH];
    clean(text, line);
    bool there = !*line;
    for (int i = 0; i < credits->count; i++)
        there |= strcmp(credits->line[i], line) == 0;
    if (there)
        return;
    if (credits->count == TC_CREDITS)
        strcpy(credits->line[TC_CREDITS - 1], OTHERS);
    else
        strcpy(credits->line[credits->count++], line);
}

void tc_credits_take(void *credits, const char *text)
{
    tc_credits_add(credits, text);
}

void tc_credits_join(const tc_credits *credits, char text[TC_CREDITS_TEXT])
{
    int length = 0;
    *text = '\0';
    for (int i = 0; i < credits->count; i++)
        length += snprintf(text + length, TC_CREDITS_TEXT - (size_t)length, "%s%s", i ? "\n" : "", credits->line[i]);
}
