"""How Python enters: with the processor's usual state, and with hints about names of arguments."""

import ctypes
import functools
import inspect

from . import _native

# Room for a fenv_t: C libraries take 8 to 32 bytes.
FENV_BYTES = 64

# What the command calls an argument, and two names of other renderers.
OTHER_NAMES = {"at": "target", "from_": "eye", "size": "width and height", "aov": "layers", "spp": "samples", "look_at": "target"}


def _environment():
    """fegetenv and fesetenv of the C library, and its default environment; None where there are none."""
    for name in (None, "libm.so.6"):
        try:
            library = ctypes.PyDLL(name)
            get, put = library.fegetenv, library.fesetenv
        except (AttributeError, OSError, TypeError):
            continue
        get.argtypes = put.argtypes = [ctypes.c_void_p]
        # C libraries of Linux name it by this pointer, others by a variable.
        for variable in ("_FE_DFL_ENV", "__fe_dfl_env"):
            try:
                return get, put, ctypes.addressof(ctypes.c_char.in_dll(library, variable))
            except ValueError:
                continue
        return get, put, ctypes.c_void_p(-1)
    return None


ENVIRONMENT = _environment()
FENV = ctypes.c_char * FENV_BYTES


def entry(function):
    """Rounds to nearest and keeps subnormal numbers while the function works, whatever the calling thread does, and leaves
    that as it was. Threads inherit the state of the one that starts them, so all that work here have it.

    An argument of a wrong name is a TypeError that says which is meant.
    """
    names = inspect.signature(function).parameters

    @functools.wraps(function)
    def entered(*args, **options):
        if not options.keys() <= names.keys():
            raise TypeError(_unknown(function, names, next(name for name in options if name not in names)))
        if ENVIRONMENT is None:
            return function(*args, **options)
        get, put, usual = ENVIRONMENT
        found = FENV()
        get(found)
        try:
            put(usual)
            return function(*args, **options)
        finally:
            put(found)

    return entered


def _unknown(function, names, given):
    """The message about an argument of this name."""
    meant = OTHER_NAMES.get(given)
    if meant is None or meant.split()[0] not in names:
        meant = _native.did_you_mean(given, [name for name in names if name != "self"])
    hint = f"did you mean {meant}?" if meant else f"it has {', '.join(name for name in names if name != 'self')}"
    return f"{function.__name__}: there is no argument {given}; {hint}"
