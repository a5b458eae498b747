"""Kernels as parts of others: machine code is made only of what Python calls, once, with all that it calls in it.

A function stays as Numba lowered it until Python asks for its address; then all that it reaches is linked, optimised
and made machine code once (docs/notes/speed.md). This rests on internals of Numba, which the tests of this module hold.
"""

from __future__ import annotations

import hashlib
import os
import uuid
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult
from numba.core.environment import lookup_environment
from numba.core.runtime import nrtdynmod
from numba.core.targetconfig import TargetConfig

_ENVIRONMENT = "_ZN08NumbaEnv"  # begins the names of variables that point to what a function needs of Python


class Stored:
    """The code of one function in the cache, read when something is linked with it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self._reload_init: tuple[Any, ...] = ()
        self._dynamic_globals: tuple[str, ...] = ()

    def _ensure_finalized(self) -> None:
        """As it is."""

    def _get_module_for_linking(self) -> Any:
        return llvm.parse_bitcode(self.read())

    def read(self) -> bytes:
        """Its bitcode, which is what its name says."""
        data = self.file.read_bytes()
        if hashlib.sha256(data).hexdigest() != self.file.name:
            raise OSError(f"{self.file} is spoilt; without its folder, kernels are compiled anew")
        return data

    @cached_property
    def is_whole(self) -> bool:
        """Whether it is there, and as it was written."""
        try:
            return bool(self.read())
        except OSError:
            return False


class KernelPart(JITCodeLibrary):
    """The code of one function, with a list of all others that it reaches."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        self.enable_object_caching()
        self.environments: dict[str, Any] = {}  # of all that it reaches, by name
        self.code: Stored | None = None  # in the cache
        self.made = False  # machine code

    def add_linking_library(self, library: Any) -> None:
        """Remember a function that this one calls, and what that one reaches."""
        library._ensure_finalized()
        reached = (*library._linking_libraries, library) if isinstance(library, KernelPart) else (library,)
        self._linking_libraries = list(dict.fromkeys((*self._linking_libraries, *reached)))
        self.environments |= (
            library.environments if isinstance(library, KernelPart) else _environments(library._final_module)
        )

    def finalize(self) -> None:
        """Leave the code as it is."""
        self._raise_if_finalized()
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
            self._dynamic_globals.extend(library._dynamic_globals)
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """The address of a function, whose machine code is made now; 0 if it is not defined here."""
        self._ensure_finalized()
        if not self.made and _defines(self._final_module, name):
            self._get_module_for_linking()  # as it is now
            own = {function.name for function in self._final_module.functions if not function.is_declaration}
            for library in reversed(self._linking_libraries):  # who calls before who is called: only these are taken
                self._final_module.link_in(library._get_module_for_linking(), preserve=True)
            for function in self._final_module.functions:
                if not function.is_declaration and function.name not in own:
                    function.linkage = "internal"  # so that one with a single caller is put into that
            self._dynamic_globals.clear()
            self._optimize_final_module()
            self._final_module.verify()
            self.made = True
            self._finalize_final_module()
            for known, environment in self.environments.items():
                self.set_env(known, environment)
        return int(super().get_pointer_to_function(name)) if self.made else 0

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None and self.code is not None:
            self._shared_module = self.code._get_module_for_linking()
        return super()._get_module_for_linking()

    @property
    def codegen(self) -> KernelPart:
        """Whom Numba tells environments: this itself, since what is no machine code has no place for them yet."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Let the code know what it needs of Python."""
        self.environments[name] = environment
        codegen: Any = self._codegen
        if codegen._engine.is_symbol_defined(name):
            codegen.set_env(name, environment)


def _values(flags: Any) -> dict[str, Any]:
    """Options of the compiler by name, for which each call that is typed asks: by reflection a quarter of all time."""
    kind = type(flags)
    if kind not in _defaults:
        _defaults[kind] = {name: option.default for name, option in kind.options.items()}
    return {**_defaults[kind], **flags._values}


_defaults: dict[type, dict[str, Any]] = {}


setattr(TargetConfig, "values", _values)  # noqa: B010


class _Runtime:
    """Numba's functions that count references, compiled when a compiler asks for them: kept kernels have their own."""

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._compiled, name)

    @cached_property
    def _compiled(self) -> Any:
        return _compile_runtime(self._context)


_compile_runtime = nrtdynmod.compile_nrt_functions
setattr(nrtdynmod, "compile_nrt_functions", _Runtime)  # noqa: B010


class PartCompiler(Compiler):
    """Numba's compiler, whose functions are parts."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function of Python."""
        self.state.library = KernelPart(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


class ApartCompiler(PartCompiler):
    """The same for functions whose arrays share no memory with each other: loops over them need not ask whether."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function of Python."""
        self.state.flags.noalias = True
        return super().compile_extra(func)


def _environments(module: Any) -> dict[str, Any]:
    names = [variable.name for variable in module.global_variables if variable.name.startswith(_ENVIRONMENT)]
    return {name: found for name in names if (found := lookup_environment(name)) is not None}


def _defines(module: Any, name: str) -> bool:
    try:
        return not module.get_function(name).is_declaration
    except NameError:
        return False


# -- In the cache ------------------------------------------------------------------------------------------------------


def reduced(result: Any, folder: Path) -> tuple[Any, ...]:
    """What the cache keeps of a compiled function: machine code, if there is any, and the names of all its parts."""
    part: KernelPart = result.library
    names = [_kept(library, folder).file.name for library in (*part._linking_libraries, part)]
    made = (part._get_compiled_object(), _symbols(part._final_module)) if part.made else None
    library = part.name, made, names
    environments = tuple(known for known in part.environments.values() if known.can_cache())
    result.fndesc.typemap = result.fndesc.calltypes = None  # as Numba does: they may fail to be kept
    return (
        library, result.fndesc, result.environment, result.signature, result.objectmode, result.lifted,
        str(result.type_annotation), result.reload_init, environments,
    )  # fmt: skip


def rebuilt(context: Any, folder: Path, kept: tuple[Any, ...], *, other_machine: bool = False) -> Any:
    """A compiled function from the cache; None if something that belongs to it is not there.

    Parts are the same on all processors of a kind: of what another one has made, only machine code is made
    anew.
    """
    (name, made, names), *rest = kept
    *reached, own = (stored(folder / each) for each in names)
    if (made is None or other_machine) and not all(each.is_whole for each in (*reached, own)):
        return None
    part = KernelPart(context.codegen(), name)
    part.code = own
    part._linking_libraries = reached
    part._finalized = True
    if made is not None and other_machine:
        module = own._get_module_for_linking()
        for function in module.functions:
            if function.name in (rest[0].llvm_func_name, rest[0].llvm_cpython_wrapper_name):
                function.linkage = "external"  # for nothing that only others may call is linked
        part._final_module.link_in(module)
    elif made is not None:
        code, symbols = made
        part._set_compiled_object(code)
        part._finalize_final_module()
        part.made = True
        part._codegen._engine._defined_symbols |= symbols
    return CompileResult._rebuild(_Context(context, part), None, *rest)._replace(target_context=context)


class _Context:
    """Numba's context, where the library that is asked for is a given one."""

    def __init__(self, context: Any, part: KernelPart) -> None:
        self._context, self._part = context, part

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def codegen(self) -> _Context:
        return self

    def unserialize_library(self, _: Any) -> KernelPart:
        return self._part


@cache
def stored(file: Path) -> Stored:
    """One for each file, since each is linked once."""
    return Stored(file)


def _kept(library: Any, folder: Path) -> Stored:
    """The code of a library in the cache, where it is put if it is not there."""
    if isinstance(library, Stored):
        return library
    code: Stored | None = getattr(library, "code", None)
    if code is None:
        data = library._get_module_for_linking().as_bitcode()
        file = folder / hashlib.sha256(data).hexdigest()
        if not file.exists():
            folder.mkdir(exist_ok=True)
            beside = file.with_name(f"{file.name}.{uuid.uuid4().hex}")
            beside.write_bytes(data)
            os.replace(beside, file)
        code = library.code = stored(file)
    return code


def _symbols(module: Any) -> set[str]:
    return {value.name for values in (module.functions, module.global_variables) for value in values
            if not value.is_declaration}  # fmt: skip
