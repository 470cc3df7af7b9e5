// tests/faults/exhaustion_shim.cpp: a library for LD_PRELOAD that lets a program run out of memory or of threads after main began.
//
//   LATENT_EXHAUST=WHAT:N[+]   WHAT  memory: the N-th allocation, counted from 1, is refused; with "+" also all later ones of
//                                    64 KiB and more, as under `ulimit -v`, where small ones still find room;
//                                    threads: the N-th pthread_create is refused, with "+" all later ones too
//   LATENT_FAULT_HIT=FILE      created when something is refused
//
// For programs without sanitizers: these have an allocator of their own.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

constexpr std::size_t kLarge = std::size_t{64} << 10;

std::atomic<bool> begun{false};  // main
struct Limit {
    long nth = 0;  // 0: none
    bool and_later = false;
    std::atomic<long> seen{0};

    void read(const char* rule) {
        nth = std::atol(rule);
        and_later = rule[std::strlen(rule) - 1] == '+';
    }
    bool refuses(bool later_too) {
        if (!begun || nth == 0) return false;
        const long now = ++seen;
        if (now != nth && !(and_later && now > nth && later_too)) return false;
        if (const char* file = std::getenv("LATENT_FAULT_HIT")) {
            const int before = errno, fd = ::open(file, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
            if (fd >= 0) ::close(fd);
            errno = before;
        }
        return true;
    }
} memory, threads;

bool refused(std::size_t size) {
    if (!memory.refuses(size >= kLarge)) return false;
    errno = ENOMEM;
    return true;
}

int (*real_main)(int, char**, char**);

int begin_main(int argc, char** argv, char** environment) {
    if (const char* rule = std::getenv("LATENT_EXHAUST")) {
        if (std::strncmp(rule, "memory:", 7) == 0) memory.read(rule + 7);
        if (std::strncmp(rule, "threads:", 8) == 0) threads.read(rule + 8);
    }
    begun = true;
    return real_main(argc, argv, environment);
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld_fini)(),
                      void* stack_end) {
    real_main = main;
    using Function = int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, "__libc_start_main"))(begin_main, argc, argv, init, fini, rtld_fini,
                                                                                stack_end);
}

void* malloc(std::size_t size) { return refused(size) ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return refused(count * size) ? nullptr : __libc_calloc(count, size); }
void* realloc(void* before, std::size_t size) { return refused(size) ? nullptr : __libc_realloc(before, size); }
void* memalign(std::size_t alignment, std::size_t size) { return refused(size) ? nullptr : __libc_memalign(alignment, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
    *out = memalign(alignment, size);
    return *out ? 0 : ENOMEM;
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*), void* argument) {
    using Function = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    static auto* const real = reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, "pthread_create"));
    return threads.refuses(true) ? EAGAIN : real(thread, attributes, start, argument);
}

}  // extern "C"
