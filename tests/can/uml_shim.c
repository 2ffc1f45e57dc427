/* uml_shim.c - preload library that lets Debian 12's user-mode-linux (6.1) run on CPUs with AVX-512 or
 * AMX.
 *
 * User-mode-linux saves and restores its tasks' floating-point registers through ptrace(NT_X86_XSTATE)
 * with a buffer that ends after AVX (832 bytes). A host whose image is larger refuses a short one with
 * EFAULT, and the init process dies with "userspace - ptrace set fp regs failed, errno = 14". Here every
 * such call moves the whole image. The part beyond the caller's buffer is kept per task, which is known by
 * the address of its buffer. It is put back when the task is restored.
 *
 * Built and preloaded by tests/can/can_vm.sh; not part of the product. */
#include <stdarg.h>
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
    uint8_t image[IMAGE_MAX];
} tasks[TASKS];

static uint8_t whole[IMAGE_MAX];

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

static long get_whole(long pid, struct iovec *image)
{
    image->iov_base = whole;
    image->iov_len = sizeof whole;
    return syscall(SYS_ptrace, PTRACE_GETREGSET, pid, XSTATE, image);
}

static long save_registers(long pid, struct iovec *buffer)
{
    struct iovec image;
    if (get_whole(pid, &image) < 0)
        return -1;
    if (buffer->iov_len > image.iov_len)
        buffer->iov_len = image.iov_len;
    memcpy(buffer->iov_base, whole, buffer->iov_len);
    struct task *t = task_slot(buffer->iov_base);
    t->buffer = buffer->iov_base;
    memcpy(t->image, whole, sizeof whole);
    return 0;
}

static long restore_registers(long pid, const struct iovec *buffer)
{
    struct iovec image;
    uint64_t upper, lower;
    if (get_whole(pid, &image) < 0)
        return -1;
    const struct task *t = task_slot(buffer->iov_base);
    if (t->buffer == buffer->iov_base)
        memcpy(whole, t->image, image.iov_len);
    memcpy(&upper, whole + COMPONENTS_AT, sizeof upper);
    memcpy(whole, buffer->iov_base, buffer->iov_len < image.iov_len ? buffer->iov_len : image.iov_len);
    memcpy(&lower, whole + COMPONENTS_AT, sizeof lower);
    lower = (lower & COMPONENTS_LOW) | (upper & ~(uint64_t)COMPONENTS_LOW);
    memcpy(whole + COMPONENTS_AT, &lower, sizeof lower);
    return syscall(SYS_ptrace, PTRACE_SETREGSET, pid, XSTATE, &image);
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
    if (request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER) {
        long word = 0; /* the system call stores what the library function returns */
        return syscall(SYS_ptrace, request, pid, address, &word) < 0 ? -1 : word;
    }
    return syscall(SYS_ptrace, request, pid, address, data);
}
