// Verilator's runtime asks on which processors it may run; a browser has none to name.
#include <stddef.h>

int pthread_getaffinity_np(void *thread, size_t size, void *set) { return (void)thread, (void)size, (void)set, -1; }
int pthread_setaffinity_np(void *thread, size_t size, const void *set) { return (void)thread, (void)size, (void)set, -1; }
int sched_getcpu(void) { return 0; }
