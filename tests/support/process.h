/* process.h - what the system counts of processes. */
#ifndef PROCESS_H
#define PROCESS_H

#include <stdint.h>
#include <sys/types.h>

/* Bytes of this process that lie in memory. Ends the program where the system does not tell. */
double process_resident(void);

/* Bytes that a process, also one that has ended but is not waited for yet, has read from files; -1: unknown. */
int64_t process_bytes_read(pid_t process);

#endif
