/* A hostile FMU (FMI 2.0): in its first step it tries what a confined process must not be able to do, and prints for
   each attack of the list in HOSTILE_ATTACKS one line, "ATTACK name: DONE" or "ATTACK name: held". */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <termios.h>
#include <unistd.h>
typedef void (*Log)(void *, const char *, int, const char *, const char *, ...);
typedef struct { Log log; void *allocate, *release, *finished, *environment; } Callbacks;
static Log log_;
static void *environment;
static const char *target, *attacks;
static char path[4096];
static int stepped, refused;
static void say(const char *name, int done) { fprintf(stderr, "ATTACK %s: %s\n", name, done ? "DONE" : "held"); }
static char *at(const char *name) { snprintf(path, sizeof path, "%s/%s", target, name); return path; }
static int put(const char *name) {
    int file = open(at(name), O_CREAT | O_WRONLY, 0644), done = file >= 0 && write(file, "x\n", 2) == 2;
    if (file >= 0) close(file);
    return done;
}
static int is(const char *name) {
    char list[4096], *one, *rest = list;
    snprintf(list, sizeof list, "%s", attacks);
    while ((one = strsep(&rest, ","))) if (!strcmp(one, name)) return 1;
    return 0;
}
#define TRY(name, expression) if (is(name)) say(name, (expression))
static volatile int handled;
static void handler(int number) { handled = put("by-handler") ? 1 : -1; }
static void *thread(void *unused) { handled = put("by-thread") ? 1 : -1; return NULL; }
static void *sleeper(void *unused) { sleep(30); return NULL; }
static int from_thread(void) {
    pthread_t made;
    handled = 0;
    return pthread_create(&made, NULL, thread, NULL) == 0 && pthread_join(made, NULL) == 0 && handled > 0;
}
static int other_threads(void) { /* those that were there before the limits were set would run this handler without them */
    struct sigaction action = {0};
    DIR *tasks = opendir("/proc/self/task");
    struct dirent *entry;
    action.sa_handler = handler;
    sigaction(SIGUSR2, &action, NULL);
    handled = 0;
    while (tasks && (entry = readdir(tasks))) {
        pid_t one = atoi(entry->d_name);
        if (one && one != syscall(SYS_gettid)) { syscall(SYS_tgkill, getpid(), one, SIGUSR2); usleep(20000); }
        if (handled > 0) return 1;
    }
    return 0;
}
static int python(void) { /* a function of Python replaced that a watcher in the process would call */
    int (*run)(const char *) = dlsym(RTLD_DEFAULT, "PyRun_SimpleString");
    int (*ensure)(void) = dlsym(RTLD_DEFAULT, "PyGILState_Ensure");
    void (*release)(int) = dlsym(RTLD_DEFAULT, "PyGILState_Release");
    char code[8192];
    if (!run || !ensure) return 0;
    snprintf(code, sizeof code, "import os\nwas = os.getppid\ndef evil():\n    os.getppid = was\n    try:\n"
        "        open('%s/by-python', 'w').write('x')\n    except OSError:\n        pass\n    return was()\n"
        "os.getppid = evil\nevil()\n", target);
    int held = ensure();
    run(code);
    release(held);
    return access(at("by-python"), F_OK) == 0;
}
static int to_socket(int family, int type, const void *address, unsigned size) {
    int s = socket(family, type, 0);
    if (s < 0) return 0;
    return type == SOCK_DGRAM ? sendto(s, "x", 1, 0, address, size) == 1 : connect(s, address, size) == 0;
}
static int to_path(const char *name, int abstract) {
    struct sockaddr_un address = {AF_UNIX};
    snprintf(address.sun_path + abstract, 100, abstract ? "%s" : "%s/sock", abstract ? name : target);
    return to_socket(AF_UNIX, SOCK_STREAM, &address, abstract ? 3 + strlen(name) : sizeof address);
}
static int opened(const char *format, int flags) {
    snprintf(path, sizeof path, format, getppid());
    return open(path, flags) >= 0;
}
static int read_from(pid_t other) {
    char bytes[8];
    struct iovec here = {bytes, 8}, there = {(void *)0x400000, 8};
    return process_vm_readv(other, &here, 1, &there, 1, 0) == 8;
}
static int shared(void) { int id = shmget(IPC_PRIVATE, 4096, 0600); if (id >= 0) shmctl(id, IPC_RMID, NULL); return id; }
static int owns(void) { int file = open("/dev/null", O_RDONLY); return fcntl(file, F_SETOWN, getppid()) == 0; }
static int fd_of(const char *name) { return open(at(name), O_RDONLY); }
static int lowered(void) { struct rlimit most = {1, 1}; return prlimit(getppid(), RLIMIT_CPU, &most, NULL) == 0; }
static int ran(const char *program) { /* a program, without fork */
    pid_t child = vfork();
    if (child == 0) { execl(program, program, NULL); _exit(1); }
    return child > 0;
}
static void attack(void) {
    pid_t parent = getppid();
    struct timeval old[2] = {{1, 0}, {1, 0}};
    struct timespec older[2] = {{1, 0}, {1, 0}};
    struct sockaddr_in address = {AF_INET, htons(atoi(getenv("HOSTILE_PORT")))};
    struct termios terminal;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    TRY("write", put("plain"));
    TRY("truncate", truncate(at("victim"), 0) == 0);
    TRY("rename", rename(at("victim"), "stolen") == 0);
    TRY("link", link(at("victim"), "linked") == 0);
    TRY("unlink", unlink(at("victim")) == 0);
    TRY("mkdir", mkdir(at("folder"), 0755) == 0);
    TRY("symlink", symlink("/", at("symlink")) == 0);
    TRY("fifo", mkfifo(at("fifo"), 0644) == 0);
    TRY("chmod", chmod(at("victim"), 0777) == 0);
    TRY("fchmod", fchmod(fd_of("victim"), 0777) == 0);
    TRY("fchmodat2", syscall(452, AT_FDCWD, at("victim"), 0777, 0) == 0);
    TRY("chown", chown(at("victim"), 1, 1) == 0 || lchown(path, -1, getgid()) == 0);
    TRY("utimes", utimes(at("victim"), old) == 0);
    TRY("futimens", futimens(fd_of("victim"), older) == 0);
    TRY("setxattr", setxattr(at("victim"), "user.x", "y", 1, 0) == 0);
    TRY("chattr", ioctl(fd_of("victim"), 0x40086602, (int[]){0x80}) == 0);
    TRY("read", fd_of("victim") >= 0);
    TRY("tcp", to_socket(AF_INET, SOCK_STREAM, &address, sizeof address));
    TRY("udp", to_socket(AF_INET, SOCK_DGRAM, &address, sizeof address));
    TRY("unix", to_path("", 0));
    TRY("abstract", to_path("hostile", 1));
    TRY("socketpair", socketpair(AF_UNIX, SOCK_DGRAM, 0, (int[2]){0}) == 0);
    TRY("io_uring", syscall(425, 1, calloc(1, 512)) >= 0);
    TRY("signal", kill(parent, 0) == 0);
    TRY("signal group", kill(-getpgid(parent), 0) == 0 || kill(-1, 0) == 0);
    TRY("signal by file", owns());
    TRY("pidfd", syscall(424, syscall(434, parent, 0), 0, NULL, 0) == 0);
    TRY("limit of parent", lowered());
    TRY("priority of parent", setpriority(PRIO_PROCESS, parent, 19) == 0);
    TRY("ptrace", ptrace(PTRACE_ATTACH, parent, 0, 0) == 0);
    TRY("memory of parent", read_from(parent) || opened("/proc/%d/mem", O_RDWR));
    TRY("environment of parent", opened("/proc/%d/environ", O_RDONLY));
    TRY("files of parent", opened("/proc/%d/fd", O_RDONLY | O_DIRECTORY));
    TRY("list of processes", open("/proc", O_RDONLY | O_DIRECTORY) >= 0 && opendir("/proc") && readdir(opendir("/proc")));
    TRY("secret of environment", getenv("HOSTILE_API_TOKEN") != NULL);
    TRY("mount", mount("tmpfs", target, "tmpfs", 0, "") == 0);
    TRY("namespace", unshare(CLONE_NEWNS) == 0 || unshare(CLONE_NEWUSER) == 0);
    TRY("chroot", chroot(target) == 0);
    TRY("shared memory", shared() >= 0);
    TRY("posix shared memory", shm_open("/hostile", O_CREAT | O_RDWR, 0600) >= 0);
    TRY("memfd", syscall(SYS_memfd_create, "x", 0) >= 0);
    TRY("terminal", ioctl(2, TIOCSTI, "x") == 0 || tcgetattr(2, &terminal) == 0);
    TRY("program", ran("/bin/true"));
    TRY("keyring", syscall(SYS_add_key, "user", "x", "y", 1, -4) >= 0);
    TRY("thread", from_thread());
    TRY("watcher", other_threads());
    TRY("python", python());
    TRY("large file", ({ int f = open("large", O_CREAT | O_WRONLY, 0600); signal(SIGXFSZ, SIG_IGN); ftruncate(f, 1L << 32) == 0; }));
    if (is("daemon")) { pid_t p = fork(); if (p == 0) { setsid(); if (fork()) _exit(0); sleep(100); _exit(0); } say("daemon", p > 0); }
    if (is("bomb")) { int n = 0; while (n < 400 && fork() > 0) n++; say("bomb", n > 0); }
    if (is("threads")) {
        pthread_attr_t small; pthread_t made; int n = 0;
        pthread_attr_init(&small); pthread_attr_setstacksize(&small, 1 << 16);
        while (n < 20000 && pthread_create(&made, &small, sleeper, NULL) == 0) n++;
        sleep(5); say("threads", n > 10000);
    }
    if (is("memory")) { size_t n = 0; for (char *p; n < 40000 && (p = malloc(1 << 20)); n++) memset(p, 1, 1 << 20); say("memory", n > 1000); }
    if (is("shared anonymous")) {
        size_t n = 0;
        for (char *p; n < 40000; n++) {
            p = mmap(NULL, 1 << 20, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
            if (p == MAP_FAILED) break;
            memset(p, 1, 1 << 20);
        }
        say("shared anonymous", n > 6000);
    }
    if (is("fill")) {
        char name[64], *bytes = calloc(1, 1 << 20);
        for (int n = 0; n < 40; n++) { snprintf(name, sizeof name, "%s/fill-%d", getenv("TMPDIR"), n); int f = open(name, O_CREAT | O_WRONLY, 0600);
            for (int i = 0; i < 256; i++) if (write(f, bytes, 1 << 20) < 0) break; close(f); }
        say("fill", 1);
    }
    if (is("forge")) for (int file = 3; file < 64; file++) if ((fcntl(file, F_GETFL) & O_ACCMODE) == O_WRONLY && fcntl(file, F_GETFL) >= 0) {
        FILE *in = fopen(getenv("HOSTILE_FORGERY"), "rb"); char bytes[65536]; size_t size = fread(bytes, 1, sizeof bytes, in);
        write(file, bytes, size); fclose(in); }
    if (is("escape")) { log_(environment, "hostile", 3, "logStatusError", "\033]0;pwned\007\033[2J\xc2\x9b" "2J"); fprintf(stderr, "\033]0;pwned\007\xc2\x9b" "2J\n"); refused = 1; }
    if (is("flood")) for (long i = 0; i < 500000; i++) log_(environment, "hostile", 1, "x", "spam spam spam spam %d", (int)i);
    if (is("print")) for (long i = 0; i < 400000; i++) fprintf(stderr, "spam spam spam spam spam spam spam spam spam spam\n");
}
void *fmi2Instantiate(const char *n, int t, const char *g, const char *w, const Callbacks *c, int v, int l) {
    log_ = c->log; environment = c->environment; target = getenv("HOSTILE_TARGET"); attacks = getenv("HOSTILE_ATTACKS");
    return calloc(1, 8);
}
void fmi2FreeInstance(void *s) {}
const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
int fmi2SetupExperiment(void *s, int a, double b, double c, int d, double e) { return 0; }
int fmi2EnterInitializationMode(void *s) { return 0; }
int fmi2ExitInitializationMode(void *s) { return 0; }
int fmi2Terminate(void *s) { return 0; }
int fmi2Reset(void *s) { return 0; }
int fmi2SetDebugLogging(void *s, int on, size_t n, const char *const *names) { return 0; }
int fmi2GetReal(void *s, const unsigned *r, size_t n, double *x) { for (size_t i = 0; i < n; i++) x[i] = 100.0; return 0; }
int fmi2SetReal(void *s, const unsigned *r, size_t n, const double *x) { return 0; }
int fmi2DoStep(void *s, double t, double h, int f) { if (!stepped++) { chdir(getenv("TMPDIR")); attack(); } return refused ? 3 : 0; }
