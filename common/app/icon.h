/* icon.h - the programs' icon as pixels, for windows: share/icons/hicolor/scalable/apps/terraclip.svg, less its grids.
 */
#ifndef TC_ICON_H
#define TC_ICON_H

#include <stdint.h>

/* size x size of them, from the upper left, not premultiplied. */
void tc_icon_draw(int size, uint8_t (*rgba)[4]);

#endif
