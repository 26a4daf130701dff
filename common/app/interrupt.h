/* interrupt.h - whether the user has asked to end. */
#ifndef TC_INTERRUPT_H
#define TC_INTERRUPT_H

#include <stdbool.h>

/* From here on Ctrl-C and SIGTERM only make tc_interrupted tell so. A second one ends the program at once. */
void tc_watch_interrupts(void);

/* The same by other means; and whether it was asked for. Any thread. */
void tc_interrupt(void);
bool tc_interrupted(void);

#endif
