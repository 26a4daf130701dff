/* interrupt.c - the flag that Ctrl-C sets. */
#include "interrupt.h"

#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>

/* A handler can only reach a global; threads read it. */
static atomic_int interrupted;

static void on_signal(int number)
{
    (void)number;
    atomic_store(&interrupted, 1);
}

void tc_watch_interrupts(void)
{
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN); /* a file too large is then an error like a full disk */
}

void tc_interrupt(void)
{
    atomic_store(&interrupted, 1);
}

bool tc_interrupted(void)
{
    return atomic_load(&interrupted);
}
