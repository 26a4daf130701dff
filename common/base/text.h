/* text.h - what is common to all text files that are read. */
#ifndef TC_TEXT_H
#define TC_TEXT_H

#include <stddef.h>
#include <string.h>

/* Bytes of the byte order mark that some editors begin a file with, at the begin of its text: 3, or 0 for none. */
static inline size_t tc_text_mark(const char *text)
{
    static const char mark[] = "\xef\xbb\xbf";
    return strncmp(text, mark, sizeof mark - 1) == 0 ? sizeof mark - 1 : 0;
}

#endif
