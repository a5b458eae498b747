"""The libraries inside FMUs: the functions of FMI 2.0 and 3.0 for co-simulation, called through FMPy."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from ctypes import byref, c_char, c_double, c_int, c_size_t, c_ubyte, c_uint, c_void_p
from functools import cache
from itertools import count
from typing import Any

from ropewalk.external.fmu_wiring import StartValue, Wiring

DISCARD, ERROR, FATAL, PENDING = 2, 3, 4, 5
STATUS = {DISCARD: "discard", ERROR: "error", FATAL: "fatal", PENDING: "pending, it would answer later"}

Listener = Callable[[int, str], None]
"""What hears the messages of an FMU, with their status."""


class Refusal(Exception):
    """A function of an FMU that was refused."""

    def __init__(self, function: str, status: int) -> None:
        self.status = status
        super().__init__(f"{function}: {STATUS.get(status, f'status {status}')}")


class Binary:
    """The library of an FMU with one instance: what FMI 2.0 and 3.0 have in common.

    `inputs`, `slopes` and `outputs` are arrays that are filled before `put` and `slope`, and by `fetch`.
    """

    prefix = ""
    saving = ("", "", "")
    packing = ("", "", "")
    byte: Any = c_ubyte

    def __init__(self, wiring: Wiring, fmu: Any) -> None:
        n, m = len(wiring.inputs), len(wiring.outputs)
        self._fmu, self._dll, self._instance = fmu, fmu.dll, fmu.component
        self._goes_back = wiring.goes_back
        self._references, self._asked = (c_uint * n)(*wiring.inputs), (c_uint * m)(*wiring.outputs)
        self.inputs: Any = (c_double * n)()
        self.slopes: Any = (c_double * n)()
        self.outputs: Any = (c_double * m)()
        self._orders = (c_int * n)(*[1] * n)
        self._worst = 0

    def put(self) -> None:
        """Set the inputs."""
        raise NotImplementedError

    def slope(self) -> None:
        """Set the slopes of the inputs."""
        raise NotImplementedError

    def fetch(self) -> None:
        """Get the outputs."""
        raise NotImplementedError

    def step(self, t: float, h: float) -> None:
        """Go on from t by h, in s."""
        raise NotImplementedError

    def set(self, setting: StartValue) -> None:
        """Set a variable before the beginning."""
        raise NotImplementedError

    def enter(self, until: float) -> None:
        """Begin to initialise."""
        raise NotImplementedError

    def leave(self) -> None:
        """Finish initialising."""
        self._call("ExitInitializationMode")

    def save(self) -> Any:
        """Copy the state."""
        state = c_void_p()
        self._call(self.saving[0], byref(state))
        return state

    def restore(self, state: Any) -> None:
        """Take a copied state."""
        self._call(self.saving[1], state)

    def pack(self, state: Any) -> bytes:
        """A copied state as bytes."""
        size = c_size_t()
        self._call(self.packing[0], state, byref(size))
        data = (self.byte * size.value)()
        self._call(self.packing[1], state, data, size)
        return bytes(data)

    def unpack(self, data: bytes) -> Any:
        """A state, to be taken and freed, from bytes."""
        state = c_void_p()
        self._call(self.packing[2], (self.byte * len(data)).from_buffer_copy(data), c_size_t(len(data)), byref(state))
        return state

    def forget(self, state: Any) -> None:
        """Free a copied state; what has failed is left as it is."""
        if self._worst < ERROR:
            with suppress(Refusal):
                self._call(self.saving[2], byref(state))

    def close(self) -> None:
        """End and free the instance; after a fatal error the standard allows no call at all."""
        if self._worst < ERROR:
            with suppress(Refusal):
                self._call("Terminate")
        if self._worst < FATAL:
            self._fmu.freeInstance()

    def _call(self, function: str, *arguments: Any) -> None:
        function = self.prefix + function
        status = getattr(self._dll, function)(self._instance, *arguments)
        if status > 1:
            self._refused(function, status)

    def _refused(self, function: str, status: int) -> None:
        self._worst = max(self._worst, ERROR if status == PENDING else status)
        raise Refusal(function, status)


class Binary2(Binary):
    """The library of an FMU of FMI 2.0."""

    prefix = "fmi2"
    saving = ("GetFMUstate", "SetFMUstate", "FreeFMUstate")
    packing = ("SerializedFMUstateSize", "SerializeFMUstate", "DeSerializeFMUstate")
    byte = c_char

    def __init__(self, wiring: Wiring, folder: str, listen: Listener) -> None:
        from fmpy import calloc, fmi2, free

        fmu = fmi2.FMU2Slave(
            guid=wiring.token, modelIdentifier=wiring.identifier, unzipDirectory=folder, instanceName=wiring.name
        )
        number = next(_NUMBERS)
        _LISTENERS[number] = listen
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = _loudspeaker()
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        callbacks.componentEnvironment = number
        with suppress(Exception):  # where FMPy has no such library, messages keep their %d
            from fmpy.logging import addLoggerProxy

            addLoggerProxy(byref(callbacks))
        try:
            fmu.instantiate(callbacks=callbacks, loggingOn=True)
        except BaseException:
            del _LISTENERS[number]
            fmu.freeLibrary()
            raise
        super().__init__(wiring, fmu)
        self._number = number
        self._put, self._get, self._do = self._dll.fmi2SetReal, self._dll.fmi2GetReal, self._dll.fmi2DoStep
        self._final = 0 if wiring.goes_back else 1

    def put(self) -> None:
        """Set the inputs."""
        if (status := self._put(self._instance, self._references, len(self._references), self.inputs)) > 1:
            self._refused("fmi2SetReal", status)

    def slope(self) -> None:
        """Set the slopes of the inputs."""
        self._call("SetRealInputDerivatives", self._references, len(self._references), self._orders, self.slopes)

    def fetch(self) -> None:
        """Get the outputs."""
        if (status := self._get(self._instance, self._asked, len(self._asked), self.outputs)) > 1:
            self._refused("fmi2GetReal", status)

    def step(self, t: float, h: float) -> None:
        """Go on from t by h, in s."""
        if (status := self._do(self._instance, t, h, self._final)) > 1:
            self._refused("fmi2DoStep", status)

    def set(self, setting: StartValue) -> None:
        """Set a variable before the beginning."""
        from fmpy import fmi2

        kind = "Integer" if setting.type == "Enumeration" else setting.type
        value = setting.value.encode() if isinstance(setting.value, str) else setting.value
        self._call(f"Set{kind}", (c_uint * 1)(setting.reference), 1, (getattr(fmi2, f"fmi2{kind}") * 1)(value))

    def enter(self, until: float) -> None:
        """Begin to initialise."""
        self._call("SetupExperiment", 0, 0.0, 0.0, 1, until)
        self._call("EnterInitializationMode")

    def close(self) -> None:
        """End and free the instance."""
        super().close()
        _LISTENERS.pop(self._number, None)


class Binary3(Binary):
    """The library of an FMU of FMI 3.0."""

    prefix = "fmi3"
    saving = ("GetFMUState", "SetFMUState", "FreeFMUState")
    packing = ("SerializedFMUStateSize", "SerializeFMUState", "DeserializeFMUState")

    def __init__(self, wiring: Wiring, folder: str, listen: Listener) -> None:
        from fmpy import fmi3

        fmu = fmi3.FMU3Slave(
            guid=wiring.token, modelIdentifier=wiring.identifier, unzipDirectory=folder, instanceName=wiring.name
        )

        def hear(_environment: Any, status: int, _category: bytes | None, message: bytes | None) -> None:
            listen(status, (message or b"").decode(errors="replace"))

        try:
            fmu.instantiate(loggingOn=True, logMessage=hear)
        except BaseException:
            fmu.freeLibrary()
            raise
        super().__init__(wiring, fmu)
        self._put, self._get, self._do = self._dll.fmi3SetFloat64, self._dll.fmi3GetFloat64, self._dll.fmi3DoStep
        self._final = not wiring.goes_back
        self._event, self._end, self._early = (fmi3.fmi3Boolean() for _ in range(3))
        self._last = c_double()
        self._signs = byref(self._event), byref(self._end), byref(self._early), byref(self._last)

    def put(self) -> None:
        """Set the inputs."""
        n = len(self._references)
        if (status := self._put(self._instance, self._references, n, self.inputs, n)) > 1:
            self._refused("fmi3SetFloat64", status)

    def fetch(self) -> None:
        """Get the outputs."""
        n = len(self._asked)
        if (status := self._get(self._instance, self._asked, n, self.outputs, n)) > 1:
            self._refused("fmi3GetFloat64", status)

    def step(self, t: float, h: float) -> None:
        """Go on from t by h, in s."""
        status = self._do(self._instance, t, h, self._final, *self._signs)
        if status > 1:
            self._refused("fmi3DoStep", status)
        if self._end.value:
            raise Refusal("fmi3DoStep requests the end of the simulation", status)

    def set(self, setting: StartValue) -> None:
        """Set a variable before the beginning."""
        from fmpy import fmi3

        kind = "Int64" if setting.type == "Enumeration" else setting.type
        value = setting.value.encode() if isinstance(setting.value, str) else setting.value
        self._call(f"Set{kind}", (c_uint * 1)(setting.reference), 1, (getattr(fmi3, f"fmi3{kind}") * 1)(value), 1)

    def enter(self, until: float) -> None:
        """Begin to initialise."""
        self._call("EnterInitializationMode", False, 0.0, 0.0, True, until)


def binary_of(wiring: Wiring, folder: str, listen: Listener) -> Binary:
    """Load the library of an FMU that has been unpacked, and make an instance.

    Raises:
        Exception: whatever FMPy or the FMU raise.
    """
    return (Binary3 if wiring.version == 3 else Binary2)(wiring, folder, listen)


# FMPy has one place for the logger of all FMUs of FMI 2.0 in a process: the last one that was given. So all are given
# the same, which lives as long as the process and finds the listener by the environment that the FMU hands back.
_LISTENERS: dict[int, Listener] = {}
_NUMBERS = count(1)


@cache
def _loudspeaker() -> Any:
    from fmpy import fmi2

    def hear(number: int | None, _instance: Any, status: int, _category: Any, message: bytes | None) -> None:
        listener = _LISTENERS.get(number or 0)
        if listener is not None:
            listener(status, (message or b"").decode(errors="replace"))

    return fmi2.fmi2CallbackLoggerTYPE(hear)
