/* kept.h - heights that take long to make, kept from one program to the next. */
#ifndef KEPT_H
#define KEPT_H

#include <stddef.h>

/* Fills z with what make(context, z) makes. Where TERRACLIP_TERRAINS names a folder, it is made once and kept there in
 * a file of that name; for a new version of what makes it the folder must be emptied. */
void kept_heights(const char *name, size_t samples, void (*make)(void *context, float *z), void *context, float *z);

#endif
