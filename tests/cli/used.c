/* used.c - used OUT COMMAND...: runs a command and writes into OUT what it took: "MB MB", the most memory it had at
 * once and what it read from files. Ends as the command does. */
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/process.h"

int main(int argc, char **argv)
{
    if (argc < 3)
        return 99;
    pid_t process = fork();
    if (process == 0) {
        execvp(argv[2], argv + 2);
        perror(argv[2]);
        _exit(99);
    }
    siginfo_t ended;
    struct rusage used;
    int status;
    if (process < 0 || waitid(P_PID, (id_t)process, &ended, WEXITED | WNOWAIT) != 0)
        return 99;
    long long bytes = (long long)process_bytes_read(process);
    if (wait4(process, &status, 0, &used) != process)
        return 99;
    FILE *out = fopen(argv[1], "w");
    if (!out || fprintf(out, "%ld %lld\n", used.ru_maxrss / 1024, bytes < 0 ? -1 : bytes / 1000000) < 0 || fclose(out))
        return 99;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
