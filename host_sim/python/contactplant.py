"""contactplant.py - contactplant in Python: a plant inside a test, and a controller for a plant on a bus.

One file over libcontactplant.so, with the standard library only; copy it wherever you like. contactplant.h is the
manual of each function; most names here are the same without their prefix.

    import contactplant
    rig = contactplant.Plant("rig")                # a model, a preset, the text of a scene, or a pathlib.Path
    rig.drive("force", 3.0, 225.0, ramp_s=0.1)     # 3 N at 225 Hz, ramped up in 0.1 s
    rig.advance_to(0.5)                            # s
    rig.output("contact_force")                    # N

    Plant             a plant alone: set inputs, advance time, read outputs and events
    Microscope        an AFM lever over a sample, in codes of a controller's converters
    App               a plant on a bus in memory: `contactplant run` without sockets and clock
    Client            a controller, over an App or over Udp
    Run               the program `contactplant run --lockstep` in a process of its own
    CannelloniBus     a bus of python-can over UDP, where python-can is installed
    plant, lockstep   fixtures, where pytest runs

UNITS. Everything is in SI: N, m, s, Hz, rad. numbers() lists names, units and ranges.

ERRORS. contactplant.Error has the library's text, which says what to do, and a code. A call that failed has
changed nothing.

THREADS. An object is used by one thread at a time; two objects know nothing of each other."""
import collections
import ctypes
import enum
import operator
import os
import pathlib
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import weakref

ABI = 1  # of the library that this file is written for: CONTACTPLANT_ABI of contactplant.h
_LIBRARY = f"libcontactplant.so.{ABI}"
_PLANT_BYTES = _CLIENT_BYTES = 131072  # CONTACTPLANT_SIZE, CONTACTPLANT_CLIENT_SIZE
_AFM_BYTES = 32768  # CONTACTPLANT_AFM_SIZE
_PACKET_BYTES, _PACKET_FRAMES = 1400, 408
_WORD_FRAMES = 100  # there is room for these in one packet
_MORE_BYTES = 1388  # in lockstep, a packet of so many bytes says that another one follows


class Code(enum.IntEnum):
    """The kind of an error: enum contactplant_code."""
    (OK, BAD_HANDLE, BAD_MEMORY, BAD_SCENE, BAD_NAME, BAD_INDEX, BAD_VALUE, BAD_ORDER, BAD_BYTES, FULL, DIVERGED,
     TIMEOUT, REFUSED) = range(13)


class State(enum.IntEnum):
    """A plant on a bus is in one of these: enum contactplant_plant_state."""
    OFF, READY, RUNNING, PAUSED, STOPPED, FROZEN, FAULT = range(7)


class Error(Exception):
    """Its text is one line that says what to do; .code is a Code."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = Code(code)


Number = collections.namedtuple("Number", "index name unit meaning min max initial")
Event = collections.namedtuple("Event", "time_s tick fraction speed peak_force_N contact touch")
_KINDS = {"input": 0, "output": 1, "state": 2, "parameter": 3, "setting": 4}
_COUNTERS = {"switches": 0, "events_lost": 1, "switches_missed": 2, "unsure": 3, "not_finite": 4}
_TRUTHS = {"deflection": 0, "z": 1, "surface": 2, "peak_force": 3, "amplitude": 4, "frequency": 5, "crashes": 6,
           "crash_force": 7, "clipped": 8, "cycle_force": 9, "adhesion": 10, "modulus": 11, "deformation": 12,
           "dissipation": 13, "snap_in": 14, "baseline": 15}
_OPERATIONS = {"start": 1, "stop": 2, "pause": 3, "step": 4, "run_until": 5, "reset": 6}
_WAITS = {"alive": 0, "state": 1, "tick": 2, "contact": 3, "reply": 4}


def _whole(what, value, bits):
    """ctypes would cut a number that is too large, and take -1 for a huge one."""
    n = operator.index(value)
    if not 0 <= n < 1 << bits:
        raise Error(Code.BAD_VALUE, f"{what} {n} is out of range; give 0 to {(1 << bits) - 1}")
    return n


def _code(value):
    """ctypes would cut a code that is too large; a converter holds it at its end."""
    return max(-(1 << 31), min((1 << 31) - 1, operator.index(value)))


def _choose(what, name, table):
    if name not in table:
        raise Error(Code.BAD_NAME, f"no {what} is called {name!r}; there are {', '.join(table)}")
    return table[name]


# ---- what crosses the border to C ----

class Frame(ctypes.Structure):
    """A classic CAN frame: Frame(0x201, b"12345678"). It has .id, .data, .extended."""
    _fields_ = [("id", ctypes.c_uint32), ("length", ctypes.c_uint8), ("extended", ctypes.c_uint8),
                ("bytes", ctypes.c_uint8 * 8)]

    def __init__(self, id=0, data=b"", extended=False):
        if len(data) > 8:
            raise Error(Code.BAD_VALUE, f"a classic CAN frame has 8 bytes at most, not {len(data)}")
        super().__init__(_whole("identifier", id, 29 if extended else 11), len(data), bool(extended),
                         (ctypes.c_uint8 * 8)(*bytes(data)))

    @property
    def data(self):
        return bytes(self.bytes[:self.length])

    def __eq__(self, other):
        return isinstance(other, Frame) and bytes(self) == bytes(other)

    def __repr__(self):
        return f"Frame({self.id:#x}, {self.data!r}{', True' if self.extended else ''})"


class Latest(ctypes.Structure):
    """The plant's last words, as struct contactplant_latest; NaN and 0 until it spoke."""
    _fields_ = ([(name, ctypes.c_uint64) for name in ("frame", "tick", "contact_tick")]
                + [("state", ctypes.c_int32), ("session", ctypes.c_int32), ("faults", ctypes.c_uint32),
                   ("in_contact", ctypes.c_int32)]
                + [(name, ctypes.c_double) for name in ("displacement_m", "velocity_m_per_s", "penetration_m",
                                                        "force_N", "contact_loss")]
                + [(name, ctypes.c_uint64) for name in ("touchdowns", "liftoffs", "accepted", "refused",
                                                        "refused_late", "unsent", "bad")]
                + [(name, ctypes.c_double * 4) for name in ("lockin", "lockin_phase_rad")])

    def __repr__(self):
        return "Latest(" + ", ".join(f"{name}={getattr(self, name)}" for name, _ in self._fields_) + ")"


class _Number(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("unit", ctypes.c_char_p), ("meaning", ctypes.c_char_p),
                ("min", ctypes.c_double), ("max", ctypes.c_double), ("initial", ctypes.c_double)]


class _Event(ctypes.Structure):
    _fields_ = [("time_s", ctypes.c_double), ("tick", ctypes.c_uint64), ("fraction", ctypes.c_double),
                ("speed", ctypes.c_double), ("peak_force_N", ctypes.c_double), ("contact", ctypes.c_int32),
                ("touch", ctypes.c_int32)]


class _Error(ctypes.Structure):
    _fields_ = [("code", ctypes.c_int), ("text", ctypes.c_char * 512)]


_RECEIVE = _SEND = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(Frame))
_FLUSH = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
_WAIT = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_void_p, ctypes.c_double)


class _Transport(ctypes.Structure):
    _fields_ = [("context", ctypes.c_void_p), ("receive", _RECEIVE), ("send", _SEND), ("flush", _FLUSH),
                ("wait", _WAIT)]


# Result, then arguments: p pointer, s text, d double, i int, u uint32_t, U uint64_t, z size_t.
_TYPES = {"p": ctypes.c_void_p, "s": ctypes.c_char_p, "d": ctypes.c_double, "i": ctypes.c_int, "u": ctypes.c_uint32,
          "U": ctypes.c_uint64, "z": ctypes.c_size_t}
_PROTOTYPES = {
    "version": "s", "abi": "i", "scene_name": "s i", "scene_title": "s i",
    "open": "p pzsp", "open_bus": "p pzsp", "error": "s p", "count": "i pi", "find": "i pis", "describe": "i piip",
    "set_drive": "i pidddd", "set_noise": "i piduud", "set_sample": "i pidU", "silence": "i pd",
    "set_parameters": "i pipp", "set_state": "i ppi", "advance": "i pU", "advance_samples": "i pipuU",
    "advance_to": "i pd", "time": "d p", "tick": "U p", "tick_time": "d p", "substeps": "u p", "input": "d pi", "output": "d pi", "state": "d pi",
    "parameter": "d pi", "energy": "d p", "residual": "d p", "next_event": "i pp", "counter": "U pi", "hash": "U p",
    "save_size": "z p", "save": "i ppz", "restore": "i ppz", "bus_put": "i pp", "bus_frame": "i p", "bus_take": "i pp",
    "pack": "z upipp", "unpack": "i pzpi", "client_open": "p pzspp", "client_error": "s p", "client_plant": "p p",
    "client_begin": "i pd", "client_end": "i pd", "client_heartbeat": "i p", "client_control": "i piU",
    "client_arm": "i pidddd", "client_fire": "i puUd", "client_stream": "i piUd", "client_set_parameters": "i pipp",
    "afm_open": "p pzsp", "afm_error": "s p", "afm_find": "i ps", "afm_describe": "i pip", "afm_set": "i pid",
    "afm_sample": "i ppp", "afm_sample_time": "d p", "afm_truth": "d pi", "afm_save_size": "z p", "afm_save": "i ppz",
    "afm_restore": "i ppz", "client_parameter": "d pid", "client_poll": "i p", "client_wait": "i piUd", "client_latest": "i ppz"}


class _Library:
    """The functions of the library, without their prefix."""

    def __init__(self, path):
        self.path = path
        try:
            shared = ctypes.CDLL(path)
        except OSError as error:
            raise Error(Code.BAD_HANDLE, f"{error}; install contactplant, or set CONTACTPLANT_LIBRARY to the path of "
                                         f"its {_LIBRARY}") from None
        try:
            shared.contactplant_version.restype = ctypes.c_char_p
            abi, version = shared.contactplant_abi(), shared.contactplant_version().decode()
            if abi == ABI:
                self._declare(shared)
        except AttributeError as error:
            raise Error(Code.BAD_HANDLE, f"{error}; set CONTACTPLANT_LIBRARY to the path of a {_LIBRARY}") from None
        if abi != ABI:
            raise Error(Code.BAD_HANDLE, f"{path} is contactplant {version} of ABI {abi}, and this contactplant.py is "
                                         f"for ABI {ABI}; use the contactplant.py that came with the library")

    def _declare(self, shared):
        for name, prototype in _PROTOTYPES.items():
            function = getattr(shared, "contactplant_" + name)
            result, _, arguments = prototype.partition(" ")
            function.restype, function.argtypes = _TYPES[result], [_TYPES[a] for a in arguments]
            setattr(self, name, function)


def _find_library():
    """CONTACTPLANT_LIBRARY, the wheel or the tree in which this file is installed or built, or where the system looks."""
    named = os.environ.get("CONTACTPLANT_LIBRARY")
    if named:
        return named
    for folder in pathlib.Path(__file__).resolve().parents:
        for place in ("contactplant.libs", "lib", "lib64", "build"):
            if (folder / place / _LIBRARY).is_file():
                return str(folder / place / _LIBRARY)
    return _LIBRARY


_loaded = None


def library():
    """The library, loaded by the first one who needs it."""
    global _loaded
    if _loaded is None:
        _loaded = _Library(_find_library())
    return _loaded


def version():
    """The library's version, as text."""
    return library().version().decode()


def scenes():
    """{name: title} of the models and presets that a plant can be opened with."""
    names = {}
    while True:
        name = library().scene_name(len(names))
        if name is None:
            return names
        names[name.decode()] = library().scene_title(len(names)).decode()


def _scene_bytes(scene):
    """The scene as the library takes it, and what to call it in errors."""
    called = "scene"
    if scene is None:
        return None, called
    if isinstance(scene, str):
        text = scene.encode()
    elif isinstance(scene, os.PathLike):
        called, text = os.fspath(scene), pathlib.Path(scene).read_bytes() + b"\n"
    else:
        raise TypeError(f"a scene is a name, a text or a pathlib.Path, not {type(scene).__name__}")
    before, nul, _ = text.partition(b"\0")
    if nul:
        line = before.count(b"\n") + 1
        raise Error(Code.BAD_SCENE, f"{called}:{line}: a NUL character")
    return text, called


def _open(function, size, scene, *transport):
    """Memory, and the handle of what was opened in it."""
    text, called = _scene_bytes(scene)
    memory, error = (ctypes.c_uint64 * (size // 8))(), _Error()
    handle = function(memory, size, text, *transport, ctypes.byref(error))
    if not handle:
        why = error.text.decode(errors="replace")
        raise Error(error.code, called + why[5:] if why.startswith("scene:") else why)
    return memory, handle


def _index_and_value(values, find):
    """{name: value} as two arrays."""
    n = len(values)
    return n, (ctypes.c_int * n)(*map(find, values)), (ctypes.c_double * n)(*map(float, values.values()))


# ---- a plant ----

class _Numbers:
    """Names, time and readings: a plant alone or on a bus."""

    def _begin(self, lib, handle, memory):
        self._lib, self._handle, self._memory, self._table = lib, handle, memory, {}
        self.substeps, self.tick_time = lib.substeps(handle), lib.tick_time(handle)  # ticks in a frame; s

    def __reduce_ex__(self, _):
        raise TypeError("a plant cannot be copied; use save(), and restore() of another one")

    def _fail(self, code):
        raise Error(code, self._lib.error(self._handle).decode())

    def _call(self, function, *arguments):
        code = function(self._handle, *arguments)
        if code:
            self._fail(code)

    def _index(self, kind, which):
        try:
            return self._table[kind, which]
        except KeyError:
            self._table[kind, which] = self._find(kind, which)
            return self._table[kind, which]

    def _find(self, kind, which):
        if not isinstance(which, str):
            self._describe(kind, _whole("index", which, 31))
            return operator.index(which)
        name = which.encode()
        if "\0" in which:
            raise Error(Code.BAD_NAME, f"no {kind} is called {which!r}")
        index = self._lib.find(self._handle, _KINDS[kind], name)
        if index < 0 and kind == "parameter":
            index = self._lib.find(self._handle, _KINDS["setting"], name)
            if index < 0:
                index = self._lib.find(self._handle, _KINDS[kind], name)  # the error speaks of parameters
        if index < 0:
            self._fail(Code.BAD_NAME)
        return index

    def _describe(self, kind, index):
        number = _Number()
        self._call(self._lib.describe, _KINDS[kind], index, ctypes.byref(number))
        return Number(index, number.name.decode(), number.unit.decode(), number.meaning.decode(), number.min,
                      number.max, number.initial)

    def numbers(self, kind):
        """Every "input", "output", "state", "parameter" or "setting", as a list of Number."""
        first = 64 if _choose("kind of number", kind, _KINDS) == _KINDS["setting"] else 0
        count = self._lib.count(self._handle, _KINDS[kind])
        return [self._describe(kind, first + i) for i in range(count)]

    def input(self, name):
        """The sum of drive, noise and sample, in the input's unit. Every name may be an index."""
        return self._lib.input(self._handle, self._index("input", name))

    def output(self, name):
        """In the output's unit."""
        return self._lib.output(self._handle, self._index("output", name))

    def outputs(self):
        """{name: value} of all outputs."""
        return {number.name: self.output(number.index) for number in self.numbers("output")}

    def state(self, name):
        """In the state's unit."""
        return self._lib.state(self._handle, self._index("state", name))

    def parameter(self, name):
        """In the parameter's unit; on a bus also settings."""
        value = self._lib.parameter(self._handle, self._index("parameter", name))
        return value if value == value else self._fail(Code.BAD_INDEX)

    def set_parameters(self, **values):
        """All of them as one set: set_parameters(preload_N=60.0). On a bus also settings, before the first frame."""
        self._call(self._lib.set_parameters, *_index_and_value(values, lambda n: self._index("parameter", n)))

    time = property(lambda self: self._lib.time(self._handle), doc="Plant time, s.")
    tick = property(lambda self: self._lib.tick(self._handle), doc="Plant time in whole ticks.")
    energy = property(lambda self: self._lib.energy(self._handle), doc="Energy stored now, J.")
    residual = property(lambda self: self._lib.residual(self._handle), doc="Energy that the integration made, J.")
    hash = property(lambda self: self._lib.hash(self._handle), doc="Two runs are equal to the last bit when this is.")

    def counter(self, name):
        """How many "switches", "events_lost", "switches_missed", "unsure" or "not_finite"."""
        return self._lib.counter(self._handle, _choose("counter", name, _COUNTERS))

    def save(self):
        """The whole plant as bytes."""
        size = self._lib.save_size(self._handle)
        memory = ctypes.create_string_buffer(size)
        self._call(self._lib.save, memory, size)
        return memory.raw

    def restore(self, saved):
        """Goes on from there with the same bits."""
        saved = bytes(saved)
        self._call(self._lib.restore, saved, len(saved))


class Plant(_Numbers):
    """A plant alone, in its scene's initial state. Every name may be an index."""

    def __init__(self, scene):
        lib = library()
        memory, handle = _open(lib.open, _PLANT_BYTES, scene)
        self._begin(lib, handle, memory)

    def drive(self, input, amplitude, frequency_Hz, phase_rad=0.0, ramp_s=0.0):
        """amplitude cos(2 pi frequency t + phase), reached within ramp_s. A NaN leaves its part as it is."""
        self._call(self._lib.set_drive, self._index("input", input), float(amplitude), float(frequency_Hz),
                   float(phase_rad), float(ramp_s))

    def noise(self, input, deviation, ticks=1, seed=0, ramp_s=0.0):
        """Gaussian noise of this standard deviation, in the input's unit, on top: a new value every `ticks`."""
        self._call(self._lib.set_noise, self._index("input", input), float(deviation), _whole("ticks", ticks, 32),
                   _whole("seed", seed, 32), float(ramp_s))

    def sample(self, input, value, ticks=0):
        """A controller's output on top, in the input's unit: jumps there, or moves there within `ticks`."""
        self._call(self._lib.set_sample, self._index("input", input), float(value), _whole("ticks", ticks, 64))

    def silence(self, ramp_s=0.0):
        """Every drive, noise and sample to zero within ramp_s."""
        self._call(self._lib.silence, float(ramp_s))

    def set_state(self, *values):
        """All states in their order and units. The energy balance begins anew."""
        n = len(values)
        self._call(self._lib.set_state, (ctypes.c_double * n)(*map(float, values)), n)

    def advance(self, ticks):
        """Runs whole ticks."""
        self._call(self._lib.advance, _whole("ticks", ticks, 64))

    def advance_samples(self, input, values, ticks=1):
        """Runs these samples of an input, each held for `ticks` ticks: sample() and advance() for each, sooner."""
        n = len(values)
        self._call(self._lib.advance_samples, self._index("input", input), (ctypes.c_double * n)(*map(float, values)), n,
                   _whole("ticks", ticks, 64))

    def run(self, frames=1):
        """Runs whole frames: a millisecond each unless the scene says otherwise."""
        self.advance(operator.index(frames) * self.substeps)

    def advance_to(self, time_s):
        """Runs to this instant of plant time, rounded to 1/65536 of a tick."""
        self._call(self._lib.advance_to, float(time_s))

    def events(self):
        """The contact switches that were not taken yet, oldest first, as a list of Event. A plant keeps 32."""
        taken, event = [], _Event()
        while self._lib.next_event(self._handle, ctypes.byref(event)):
            taken.append(Event(event.time_s, event.tick, event.fraction, event.speed, event.peak_force_N,
                               event.contact, bool(event.touch)))
        return taken


class App(_Numbers):
    """A plant on a bus in memory: it moves by frames, and frame() is its only clock. A Client may have it as its
    transport."""

    def __init__(self, scene):
        lib = library()
        memory, handle = _open(lib.open_bus, _PLANT_BYTES, scene)
        self._begin(lib, handle, memory)
        self.frame_s = self.substeps * self.tick_time
        self._got = Frame()

    def put(self, frame):
        """A Frame to the plant; the next bus frame reads it."""
        self._call(self._lib.bus_put, ctypes.byref(frame))

    def frame(self):
        """One bus frame: the plant reads commands, advances, and reports."""
        self._call(self._lib.bus_frame)

    def run(self, frames):
        """So many bus frames. The plant keeps the last 512 frames that nobody takes."""
        for _ in range(_whole("frames", frames, 64)):
            self.frame()

    def take(self):
        """The oldest Frame that the plant has sent, or None."""
        return Frame.from_buffer_copy(self._got) if self._lib.bus_take(self._handle, ctypes.byref(self._got)) else None

    receive = take

    def send(self, frame):
        return self._lib.bus_put(self._handle, ctypes.byref(frame)) == Code.OK

    def wait(self, seconds):
        self.frame()
        return self.frame_s


# ---- a microscope ----

class Microscope:
    """An AFM lever of a scene (tapping, soft, stiff or a text) over a sample, in codes of a controller's converters:
    16 bits over +-10 V. Numbers of `contactplant list microscope` are given by name: Microscope("tapping",
    surface=1, drive_m=20e-9)."""

    def __init__(self, scene, **numbers):
        self._lib = library()
        self._memory, self._handle = _open(self._lib.afm_open, _AFM_BYTES, scene)
        self._dac, self._adc = (ctypes.c_int32 * 4)(), (ctypes.c_int32 * 2)()
        for name, value in numbers.items():
            index = self._lib.afm_find(self._handle, name.encode())
            self._check(self._lib.afm_set(self._handle, index, float(value)) if index >= 0 else Code.BAD_NAME)

    sample_s = property(lambda self: self._lib.afm_sample_time(self._handle), doc="Seconds of a sample.")

    def __reduce_ex__(self, _):
        raise TypeError("a microscope cannot be copied; use save(), and restore() of another one")

    def _check(self, code):
        if code:
            raise Error(code, self._lib.afm_error(self._handle).decode())

    def numbers(self):
        """What can be set before the first sample, as a list of Number."""
        found, number = [], _Number()
        while not self._lib.afm_describe(self._handle, len(found), ctypes.byref(number)):
            found.append(Number(len(found), number.name.decode(), number.unit.decode(), number.meaning.decode(),
                                number.min, number.max, number.initial))
        return found

    def sample(self, dither=0, z=0, x=0, y=0):
        """One sample with these codes of the DACs: the codes of the ADCs for deflection and z."""
        self._dac[:] = _code(dither), _code(z), _code(x), _code(y)
        self._check(self._lib.afm_sample(self._handle, self._dac, self._adc))
        return self._adc[0], self._adc[1]

    def truth(self, name):
        """A number that a controller does not know: "deflection", "z", "surface" (m), "peak_force" (N), "amplitude"
        (m), "frequency" (Hz), "crashes", "crash_force" (N), "clipped". Of the last cycle of peak_force_N: "cycle_force",
        "adhesion", "snap_in", "baseline" (N), "modulus" (Pa), "deformation" (m), "dissipation" (J)."""
        return self._lib.afm_truth(self._handle, _choose("truth", name, _TRUTHS))

    def save(self):
        """The whole microscope as bytes."""
        size = self._lib.afm_save_size(self._handle)
        memory = ctypes.create_string_buffer(size)
        self._check(self._lib.afm_save(self._handle, memory, size))
        return memory.raw

    def restore(self, saved):
        """Goes on from there with the same bits."""
        saved = bytes(saved)
        self._check(self._lib.afm_restore(self._handle, saved, len(saved)))


# ---- a controller ----

def _address(at):
    """20000 is a port of this machine, "HOST:PORT" one elsewhere."""
    host, _, port = str(at).rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise Error(Code.BAD_VALUE, f"{at!r} is no address; give a port, or \"HOST:PORT\"")
    return host or "127.0.0.1", int(port)


class Udp:
    """The way to a plant over UDP, as cannelloni packets. A plant answers its listed peers only: own port 20001 is one
    by default, run --peer lists others.

    In lockstep (run --lockstep) each wait says one word, and hears the bus frame that it begins. Then time counts bus
    frames of frame_s, and patience_s of silence are an Error."""

    def __init__(self, plant=20000, own=20001, lockstep=False, patience_s=10.0, frame_s=1e-3):
        self.lockstep, self.frame_s, self.patience_s = lockstep, frame_s, patience_s
        self._lib, at = library(), _address(own)
        if plant is not None:
            _address(plant)  # before there is a socket to close
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind(at)
        except OSError as error:
            self._socket.close()
            raise Error(Code.BAD_VALUE, f"own address {own}: {error.strerror}; give another one, which run --peer "
                                        f"lists, too") from None
        self.port = self._socket.getsockname()[1]
        self._socket.settimeout(patience_s if lockstep else None)
        self._packet = (ctypes.c_uint8 * 2048)()
        self._in, self._n_in, self._next = (Frame * _PACKET_FRAMES)(), 0, 0
        self._out, self._n_out, self._sequence = (Frame * _WORD_FRAMES)(), 0, 0
        self._heard, self._is_up = collections.deque(), False
        self.malformed = 0  # packets that were none
        if plant is not None:
            self.connect(plant)

    def __del__(self):
        if hasattr(self, "_socket"):
            self.close()

    def connect(self, plant):
        """The plant's port, or "HOST:PORT"."""
        self.plant = "%s:%d" % _address(plant)
        self._socket.connect(_address(plant))

    def close(self):
        self._socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def receive(self):
        """The next Frame that has arrived, or None. Does not wait."""
        while self._next >= self._n_in:
            packet = self._next_packet()
            if packet is None:
                return None
            self._next, self._n_in = 0, self._lib.unpack(packet, len(packet), self._in, _PACKET_FRAMES)
            self.malformed += self._n_in < 0
        self._next += 1
        return Frame.from_buffer_copy(self._in[self._next - 1])

    def _next_packet(self):
        if self.lockstep:
            return self._heard.popleft() if self._heard else None
        while True:
            try:
                return self._socket.recv(2048, socket.MSG_DONTWAIT)
            except BlockingIOError:
                return None
            except ConnectionRefusedError:  # the plant is not up yet
                pass

    def send(self, frame):
        """Keeps it for the next packet; False when that is full."""
        if self._n_out == _WORD_FRAMES:
            if self.lockstep:
                return False
            self.flush()
        self._out[self._n_out] = frame
        self._n_out += 1
        return True

    def _packed(self):
        n = self._lib.pack(self._sequence & 255, self._out, self._n_out, self._packet, None)
        self._sequence += 1
        self._n_out = 0
        return bytes(memoryview(self._packet)[:n])

    def flush(self):
        """Sends what is kept. In lockstep that is for wait to do."""
        if self._n_out and not self.lockstep:
            packet = self._packed()
            for _ in range(2):
                try:
                    return self._socket.send(packet)
                except ConnectionRefusedError:  # the news of an earlier packet: the plant was not up then
                    pass

    def wait(self, seconds):
        """Waits until something may have come; returns the seconds that went by."""
        if self.lockstep:
            self.turn()
            return self.frame_s
        begin = time.monotonic()
        select.select([self._socket], [], [], max(seconds, 0.0))
        return time.monotonic() - begin

    def turn(self):
        """In lockstep: says the word, and hears the bus frame that it begins."""
        word, packet = self._packed(), None
        end = time.monotonic() + self.patience_s
        while packet is None or len(packet) >= _MORE_BYTES:
            try:
                if packet is None:
                    self._socket.send(word)
                packet = self._socket.recv(2048)
                self._heard.append(packet)
                self._is_up = True
            except (ConnectionRefusedError, socket.timeout) as error:
                if self._is_up or isinstance(error, socket.timeout) or time.monotonic() > end:
                    raise Error(Code.TIMEOUT, f"no word of the plant at {self.plant}; does contactplant run --lockstep "
                                              f"--peer 127.0.0.1:{self.port} run there?") from None
                time.sleep(0.01)  # a plant that is not up yet: the word is said again


class Client:
    """A controller: with Client("rig", App("rig")) as me: opens a session, and closes it.

    The transport is an App, a Udp, or any object with receive() -> Frame or None, send(Frame) -> bool,
    wait(seconds) -> seconds that went by, and flush() where send only gathers. Its exceptions come out of the call
    that met them. Commands go out together when the client listens: poll and every wait do."""

    def __init__(self, scene, transport):
        self.transport, self._raised, self._begun = transport, None, False
        self._lib = lib = library()
        flush = getattr(transport, "flush", lambda: None)
        self._transport = _Transport(
            None, _RECEIVE(lambda _, to: self._guarded(0, self._receive, to)),
            _SEND(lambda _, frame: self._guarded(0, self._send, frame)), _FLUSH(lambda _: self._guarded(None, flush)),
            _WAIT(lambda _, seconds: self._guarded(-1.0, transport.wait, seconds)))
        if getattr(type(transport), "receive", None) is App.receive:  # most calls are for frames: C serves them itself
            self._transport.context = transport._handle
            self._transport.receive = ctypes.cast(lib.bus_take, _RECEIVE)
        self._memory, self._handle = _open(lib.client_open, _CLIENT_BYTES, scene, ctypes.byref(self._transport))
        self.plant = Plant.__new__(Plant)  # a plant alone of the same scene, for names and numbers
        self.plant._begin(lib, lib.client_plant(self._handle), self._memory)
        if isinstance(transport, Udp):
            transport.frame_s = self.plant.substeps * self.plant.tick_time

    def _guarded(self, failed, function, *arguments):
        """An exception cannot pass through C: it ends the wait, and is raised behind it."""
        try:
            return function(*arguments)
        except BaseException as error:
            self._raised = self._raised or error
            return failed

    def _receive(self, to):
        frame = self.transport.receive()
        if frame is None:
            return 0
        to[0] = frame
        return 1

    def _send(self, frame):
        return bool(self.transport.send(Frame.from_buffer_copy(frame[0])))

    def _check(self, code):
        if self._raised:
            error, self._raised = self._raised, None
            raise error
        if code:
            raise Error(code, self._lib.client_error(self._handle).decode())

    def _command(self, function, *arguments):
        if not self._begun:
            raise Error(Code.BAD_ORDER, "no session is open, and the plant would refuse this; call begin first")
        self._check(function(self._handle, *arguments))

    def __enter__(self):
        self.begin()
        return self

    def __exit__(self, kind, *_):
        if kind is None:
            self.end()

    def __reduce_ex__(self, _):
        raise TypeError("a client cannot be copied; open another one")

    def begin(self, seconds=5.0):
        """Opens a session. An Error of Code.REFUSED says why the plant takes none, or that its scene is another one."""
        if self._begun and self.latest.session:
            raise Error(Code.BAD_ORDER, "this session is open; call end before another begin")
        self._check(self._lib.client_begin(self._handle, float(seconds)))
        self._begun = True

    def end(self, seconds=1.0):
        """Closes the session."""
        self._begun = False
        self._check(self._lib.client_end(self._handle, float(seconds)))

    def heartbeat(self):
        """"I am here", at least every timeout_frames bus frames, which is a setting."""
        self._command(self._lib.client_heartbeat)

    def control(self, operation, argument=0):
        """"start", "stop", "pause", "step" (argument: frames), "run_until" (argument: a tick) or "reset"."""
        self._command(self._lib.client_control, _choose("operation", operation, _OPERATIONS),
                      _whole("argument", argument, 64))

    def start(self, seconds=1.0):
        """Plant time runs when this returns."""
        self.control("start")
        self.wait_state(State.RUNNING, seconds)

    def stop(self, seconds=1.0):
        """Drives are zero, and plant time stands, when this returns. The session is over, too."""
        self.control("stop")
        self.wait_state(State.STOPPED, seconds)

    def arm(self, input, amplitude, frequency_Hz, phase_rad=0.0, ramp_s=0.0):
        """Stages a drive, as Plant.drive sets it, for fire."""
        self._command(self._lib.client_arm, self.plant._index("input", input), float(amplitude), float(frequency_Hz),
                      float(phase_rad), float(ramp_s))

    def fire(self, *inputs, tick, fraction=0.0):
        """What is staged on these inputs begins at this instant of plant time."""
        bits = sum({1 << self.plant._index("input", i) for i in inputs})
        self._command(self._lib.client_fire, bits, _whole("tick", tick, 64), float(fraction))

    def stream(self, input, frame, value):
        """One sample, in the input's unit, applied at the start of that plant frame (tick // plant.substeps)."""
        self._command(self._lib.client_stream, self.plant._index("input", input), _whole("frame", frame, 64),
                      float(value))

    def set_parameters(self, **values):
        """Parameters and settings, as one set."""
        self._command(self._lib.client_set_parameters,
                      *_index_and_value(values, lambda name: self.plant._index("parameter", name)))

    def parameter(self, name, seconds=1.0):
        """A parameter or a setting, as the plant says it."""
        value = self._lib.client_parameter(self._handle, self.plant._index("parameter", name), float(seconds))
        self._check(0 if value == value else Code.TIMEOUT)
        return value

    def poll(self):
        """Hears everything that has arrived; returns the number of messages."""
        n = self._lib.client_poll(self._handle)
        self._check(0)
        return n

    def _wait(self, what, value, seconds):
        self._check(self._lib.client_wait(self._handle, _WAITS[what], value, float(seconds)))

    def wait_alive(self, seconds=5.0):
        """Hears until the plant has said something of itself."""
        self._wait("alive", 0, seconds)

    def wait_state(self, state, seconds=1.0):
        """Hears until the plant is in this State."""
        self._wait("state", State(state), seconds)

    def wait_tick(self, tick, seconds=1.0):
        """Hears until plant time is this tick or later."""
        self._wait("tick", _whole("tick", tick, 64), seconds)

    def wait_contact(self, tick, seconds=1.0):
        """Hears until penetration and contact force of this tick, or a later one, are known."""
        self._wait("contact", _whole("tick", tick, 64), seconds)

    def wait_reply(self, replies, seconds=1.0):
        """Hears until so many replies have come: latest.accepted + latest.refused."""
        self._wait("reply", _whole("replies", replies, 64), seconds)

    @property
    def latest(self):
        """A copy of what the plant said last: Latest."""
        latest = Latest()
        self._check(self._lib.client_latest(self._handle, ctypes.byref(latest), ctypes.sizeof(latest)))
        return latest


# ---- the program, python-can, pytest ----

def _find_program():
    folder = os.path.dirname(library().path)
    for place in (os.path.join(folder, "contactplant"), os.path.join(folder, os.pardir, "bin", "contactplant")):
        if folder and os.access(place, os.X_OK) and os.path.isfile(place):
            return place
    found = shutil.which("contactplant")
    if found:
        return found
    raise Error(Code.BAD_NAME, "no program contactplant beside the library or on the PATH; give Run(program=..)")


def _last_line(text):
    return (text.strip() or "it said nothing").split("\n")[-1]


class Run:
    """The program `contactplant run SCENE --lockstep OPTIONS`, in a process of its own, on a port that nobody has. Its
    .udp is the transport of a Client:

        with Run("rig", "--log", "run.log") as plant, Client("rig", plant.udp) as me: ..

    patience_s: so long does the program wait for a word, at a breakpoint for instance, before it ends."""

    def __init__(self, scene, *options, program=None, patience_s=600.0):
        self._folder, self._report = tempfile.TemporaryDirectory(), None
        self._out, self._err = [os.path.join(self._folder.name, name) for name in ("out", "err")]
        if isinstance(scene, str) and ("\n" in scene or "[" in scene):
            text, scene = scene, pathlib.Path(self._folder.name, "scene.ini")
            scene.write_text(text + "\n", encoding="utf-8")
        self.udp = Udp(None, 0, lockstep=True)
        command = [program or _find_program(), "run", os.fspath(scene), "--lockstep", "--bus", "udp:0", "--peer",
                   f"127.0.0.1:{self.udp.port}", "--patience", str(patience_s), *map(str, options)]
        self._process = None
        try:
            with open(self._out, "w") as out, open(self._err, "w") as err:
                self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err)
            weakref.finalize(self, self._process.kill)  # at the latest when Python ends
            self.udp.connect(self._port())
        except BaseException:
            self.kill()
            raise

    def _text(self, name):
        with open(name, encoding="utf-8", errors="replace") as text:
            return text.read()

    def _port(self):
        """The program says it in its first line."""
        for _ in range(2000):
            said = self._text(self._err)
            if " on udp:" in said and "Ctrl-C ends it" in said:
                return int(said.split(" on udp:")[1].split(",")[0])
            if self._process.poll() is not None:
                raise Error(Code.REFUSED, _last_line(said))
            time.sleep(0.005)
        raise Error(Code.TIMEOUT, "contactplant run said no port within 10 s: " + _last_line(said))

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self.end() if kind is None else self.kill()

    def end(self):
        """Ends it as Ctrl-C does, and returns its report. An Error when it has failed."""
        if self._report is not None:
            return self._report
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        status = self._process.wait(60)
        self._report, said = self._text(self._out), self._text(self._err)
        self.kill()
        if status:
            raise Error(Code.REFUSED, f"contactplant run ended with status {status}: {_last_line(said)}")
        return self._report

    def kill(self):
        if self._process and self._process.poll() is None:
            self._process.kill()
            self._process.wait()
        self.udp.close()
        self._folder.cleanup()


def _cannelloni_bus():
    import can

    class CannelloniBus(can.BusABC):
        """A python-can bus to a plant over UDP: CannelloniBus("127.0.0.1:20000", 20001). In lockstep, recv says a word
        whenever nothing is left to be heard."""

        def __init__(self, channel=20000, own=20001, lockstep=False, can_filters=None, **_):
            self._udp = channel.udp if isinstance(channel, Run) else Udp(channel, own, lockstep)
            self.channel_info = f"contactplant at {self._udp.plant}"
            super().__init__(channel, can_filters)

        def send(self, msg, timeout=None):
            if msg.is_remote_frame or msg.is_error_frame or msg.is_fd:
                raise can.CanOperationError("a plant takes classic data frames only")
            if not self._udp.send(Frame(msg.arbitration_id, msg.data, msg.is_extended_id)):
                raise can.CanOperationError("the word is full; call recv before you send more")
            self._udp.flush()

        def _recv_internal(self, timeout):
            frame = self._udp.receive()
            if frame is None and timeout != 0:
                self._udp.wait(1.0 if timeout is None else timeout)
                frame = self._udp.receive()
            return frame and can.Message(timestamp=time.time(), arbitration_id=frame.id, data=frame.data,
                                         is_extended_id=bool(frame.extended)), False

        def shutdown(self):
            super().shutdown()
            self._udp.close()

    return CannelloniBus


def __getattr__(name):  # importing python-can takes longer than everything else: only for those who ask for it
    if name != "CannelloniBus":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = _cannelloni_bus()
    return globals()[name]


if "pytest" in sys.modules:
    import pytest

    @pytest.fixture
    def plant(request):
        """A Plant("hertz_rig"); @pytest.mark.parametrize("plant", [SCENE, ..], indirect=True) for other scenes."""
        return Plant(getattr(request, "param", "hertz_rig"))

    @pytest.fixture
    def lockstep(request):
        """A Client in session with `contactplant run hertz_rig --lockstep`; other scenes as for the fixture plant."""
        scene = getattr(request, "param", "hertz_rig")
        with Run(scene) as run:
            client = Client(scene, run.udp)
            client.begin()
            yield client
