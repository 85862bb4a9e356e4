/* LD_PRELOAD: counts what a thread allocates and frees while it says that it is the audio thread. */
#define _GNU_SOURCE
#include <stddef.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);
extern void __libc_free(void *);

static __thread int counting __attribute__((tls_model("initial-exec")));
static __thread long calls __attribute__((tls_model("initial-exec")));

void malloc_counter_begin(void) { counting = 1; }
long malloc_counter_end(void) { return counting = 0, calls; }

void *malloc(size_t size) { return calls += counting, __libc_malloc(size); }
void *calloc(size_t n, size_t size) { return calls += counting, __libc_calloc(n, size); }
void *realloc(void *old, size_t size) { return calls += counting, __libc_realloc(old, size); }
void *memalign(size_t to, size_t size) { return calls += counting, __libc_memalign(to, size); }
void *aligned_alloc(size_t to, size_t size) { return calls += counting, __libc_memalign(to, size); }
int posix_memalign(void **place, size_t to, size_t size) {
    calls += counting;
    *place = __libc_memalign(to, size);
    return *place ? 0 : 12;
}
void free(void *old) { calls += counting && old, __libc_free(old); }
