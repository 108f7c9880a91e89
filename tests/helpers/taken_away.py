"""Runs a program in a Python that lacks what other operating systems lack.

    python taken_away.py NAME[,NAME...] MODULE [ARGUMENT ...]
    python taken_away.py NAME[,NAME...] -c PROGRAM

Names are those of `LACKING`, or `all`, or `nothing`. A text that the package's own
modules read or write in an encoding that depends on the system is an error.
"""

import asyncio  # noqa: F401, which on Linux needs os.sysconf as it is loaded
import ctypes
import multiprocessing
import os
import runpy
import signal
import sys
import warnings

import psutil  # noqa: F401, likewise


def _attributes(module, *names):
    def take():
        for name in names:
            if hasattr(module, name):
                delattr(module, name)

    return take


def _modules(*names):
    def take():
        for name in names:
            sys.modules[name] = None  # its import fails

    return take


def _directories():
    """Windows looks no file up in an open directory."""
    os.supports_dir_fd = set()
    for name in ("open", "stat", "unlink", "utime", "mkdir", "rmdir", "chmod"):
        setattr(os, name, _refusing(getattr(os, name), "dir_fd"))
    os.replace = _refusing(os.replace, "src_dir_fd", "dst_dir_fd")


def _refusing(function, *names):
    def refusing(*arguments, **options):
        if any(options.pop(name, None) is not None for name in names):
            raise NotImplementedError(f"{names[0]} unavailable on this platform")
        return function(*arguments, **options)

    return refusing


def _process_library():
    """Windows does not open the process itself as a library."""
    load = ctypes.CDLL.__init__

    def loading(self, name, *arguments, **options):
        if name is None:
            raise TypeError("bad argument type for built-in operation")
        load(self, name, *arguments, **options)

    ctypes.CDLL.__init__ = loading


def _no_affinity():
    _attributes(os, "sched_getaffinity", "sched_setaffinity")()
    # Since 3.13, where it is this on other systems
    os.process_cpu_count = os.cpu_count


def _no_forks():
    _attributes(os, "fork", "forkpty", "register_at_fork")()
    multiprocessing.set_start_method("spawn")


LACKING = {
    "sysconf": _attributes(os, "sysconf", "sysconf_names"),
    "users": _attributes(
        os, "getuid", "geteuid", "getgid", "getegid", "getgroups", "chown", "fchown"
    ),
    "affinity": _no_affinity,
    "modes": _attributes(os, "fchmod", "umask", "mkfifo"),
    "flags": _attributes(os, "O_NOFOLLOW", "O_DIRECTORY", "O_NONBLOCK", "O_CLOEXEC"),
    "directories": _directories,
    "locks": _modules("fcntl"),
    "posix modules": _modules("resource", "pwd", "grp", "termios", "tty", "pty"),
    "signals": _attributes(
        *(signal, "SIGHUP", "SIGKILL", "SIGALRM", "SIGUSR1", "SIGUSR2", "SIGPIPE"),
        *("SIGQUIT", "SIGCHLD", "pthread_sigmask", "pthread_kill", "setitimer"),
    ),
    "pipes": _attributes(os, "set_blocking", "get_blocking"),
    "exit codes": _attributes(os, *(n for n in dir(os) if n.startswith("EX_"))),
    "process library": _process_library,
    "forks": _no_forks,
}
"""What is taken away, by a name."""


def take_away(names):
    warnings.filterwarnings("ignore", category=EncodingWarning)
    warnings.filterwarnings("error", category=EncodingWarning, module="jaximpact")
    lacking = {"all": LACKING, "nothing": ()}.get(names)
    for name in names.split(",") if lacking is None else lacking:
        LACKING[name]()


if __name__ == "__main__":
    names, what, *arguments = sys.argv[1:]
    take_away(names)
    if what == "-c":
        exec(arguments[0], {"__name__": "__main__"})
    else:
        sys.argv = [what, *arguments]
        runpy.run_module(what, run_name="__main__", alter_sys=True)
