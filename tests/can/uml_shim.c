/* uml_shim.c - preload library that lets Debian 12's user-mode-linux (6.1) run on CPUs with AVX-512 or
 * AMX.
 *
 * User-mode-linux saves and restores its tasks' floating-point registers through ptrace(NT_X86_XSTATE)
 * with a buffer that ends after AVX (832 bytes). A host whose image is larger refuses a short one with
 * EFAULT, and the init process dies with "userspace - ptrace set fp regs failed, errno = 14". Here every
 * such call moves the whole image. The part beyond the caller's buffer is kept per task, which is known by
 * the address of its buffer. It is put back when the task is restored.
 *
 * Most restores follow a save without a step of the process between them. Its registers are still those of
 * the buffer then, and no call is made: a system call inside costs a third.
 *
 * Built and preloaded by tests/can/can_vm.sh; not part of the product. */
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum {
    XSTATE = 0x202,      /* NT_X86_XSTATE */
    IMAGE_MAX = 16384,   /* bytes; an image with AMX has about 11,000 */
    SHORT_IMAGE = 4096,  /* a smaller buffer is user-mode-linux's; a whole image is passed on as it is */
    COMPONENTS_AT = 512, /* XSTATE_BV: which components the image holds */
    COMPONENTS_LOW = 7,  /* x87, SSE, AVX: the part that user-mode-linux keeps itself */
    TASKS = 256          /* tasks whose upper part is remembered; further ones take over a slot */
};

static struct task {
    const void *buffer;
    size_t n; /* bytes of the image */
    uint8_t image[IMAGE_MAX];
} tasks[TASKS];

/* The process whose registers were saved last and that has not run since, and the task that has them. */
static struct {
    long pid;
    const struct task *task;
} still;

/* The slot of this buffer, or the slot it may take. */
static struct task *task_slot(const void *buffer)
{
    unsigned home = (unsigned)(((uintptr_t)buffer >> 6) * 2654435761u) % TASKS;
    for (unsigned i = 0; i < TASKS; i++) {
        struct task *t = &tasks[(home + i) % TASKS];
        if (t->buffer == buffer || !t->buffer)
            return t;
    }
    return &tasks[home];
}

static long get_whole(long pid, struct task *t)
{
    struct iovec image = {t->image, sizeof t->image};
    if (syscall(SYS_ptrace, PTRACE_GETREGSET, pid, XSTATE, &image) < 0)
        return -1;
    t->n = image.iov_len;
    return 0;
}

static long save_registers(long pid, struct iovec *buffer)
{
    struct task *t = task_slot(buffer->iov_base);
    still.pid = 0;
    t->buffer = NULL;
    if (get_whole(pid, t) < 0)
        return -1;
    t->buffer = buffer->iov_base;
    if (buffer->iov_len > t->n)
        buffer->iov_len = t->n;
    memcpy(buffer->iov_base, t->image, buffer->iov_len);
    still.pid = pid;
    still.task = t;
    return 0;
}

static long restore_registers(long pid, const struct iovec *buffer)
{
    static struct task other;
    struct task *t = task_slot(buffer->iov_base);
    uint64_t upper, lower;
    if (t->buffer != buffer->iov_base) {
        t = &other;
        if (get_whole(pid, t) < 0)
            return -1;
    }
    size_t n = buffer->iov_len < t->n ? buffer->iov_len : t->n;
    if (still.pid == pid && still.task == t && !memcmp(t->image, buffer->iov_base, n))
        return 0;
    still.pid = 0;
    memcpy(&upper, t->image + COMPONENTS_AT, sizeof upper);
    memcpy(t->image, buffer->iov_base, n);
    memcpy(&lower, t->image + COMPONENTS_AT, sizeof lower);
    lower = (lower & COMPONENTS_LOW) | (upper & ~(uint64_t)COMPONENTS_LOW);
    memcpy(t->image + COMPONENTS_AT, &lower, sizeof lower);
    struct iovec image = {t->image, t->n};
    return syscall(SYS_ptrace, PTRACE_SETREGSET, pid, XSTATE, &image);
}

/* A process stays stopped by it, with the registers that it has. */
static bool is_harmless(enum __ptrace_request request)
{
    return request == PTRACE_GETREGS || request == PTRACE_SETREGS || request == PTRACE_GETSIGINFO ||
           request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER;
}

long ptrace(enum __ptrace_request request, ...)
{
    va_list list;
    va_start(list, request);
    long pid = va_arg(list, long);
    void *address = va_arg(list, void *);
    void *data = va_arg(list, void *);
    va_end(list);
    struct iovec *buffer = data;
    if ((uintptr_t)address == XSTATE && request == PTRACE_GETREGSET && buffer->iov_len < SHORT_IMAGE)
        return save_registers(pid, buffer);
    if ((uintptr_t)address == XSTATE && request == PTRACE_SETREGSET && buffer->iov_len < SHORT_IMAGE)
        return restore_registers(pid, buffer);
    if (!is_harmless(request))
        still.pid = 0;
    if (request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER) {
        long word = 0; /* the system call stores what the library function returns */
        return syscall(SYS_ptrace, request, pid, address, &word) < 0 ? -1 : word;
    }
    return syscall(SYS_ptrace, request, pid, address, data);
}
