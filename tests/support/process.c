/* process.c */
#include "process.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

double process_resident(void)
{
    long long resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%*s %lld", &resident) != 1)
        exit(99);
    fclose(file);
    return (double)resident * (double)sysconf(_SC_PAGESIZE);
}

int64_t process_bytes_read(pid_t process)
{
    char name[64], line[80];
    long long bytes = -1;
    snprintf(name, sizeof name, "/proc/%ld/io", (long)process);
    FILE *file = fopen(name, "r");
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "rchar: %lld", &bytes) == 1)
            break;
    if (file)
        fclose(file);
    return bytes;
}
