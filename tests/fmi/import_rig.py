#!/usr/bin/python3
"""import_rig.py FMU_FOLDER CONTACTPLANT - an importer that shares nothing with the FMU's sources: the standard's functions by ctypes,
with argument types of its own, variables by a real XML parser. Prints a line a check.

The motion is compared with `contactplant simulate` by the method taylor at its full accuracy."""
import ctypes
import glob
import subprocess
import sys
import xml.etree.ElementTree as tree

folder, program = sys.argv[1:3]
root = tree.parse(folder + '/modelDescription.xml').getroot()
reference = {v.get('name'): int(v.get('valueReference')) for v in root.find('ModelVariables')}
fmi = ctypes.CDLL(glob.glob(folder + '/binaries/*/contactplant.so')[0])
text, handle, boolean, real, size = ctypes.c_char_p, ctypes.c_void_p, ctypes.c_bool, ctypes.c_double, ctypes.c_size_t
messages = []
LOGGER = ctypes.CFUNCTYPE(None, handle, ctypes.c_int, text, text)
logger = LOGGER(lambda environment, status, category, message: messages.append((status, category, message)))
failed = 0


def function(name, result, *arguments):
    f = getattr(fmi, name)
    f.restype, f.argtypes = result, arguments
    return f


def check(what, good):
    global failed
    failed += not good
    print(('ok    ' if good else 'FAIL  ') + what)


references = ctypes.POINTER(ctypes.c_uint32)
instantiate = function('fmi3InstantiateCoSimulation', handle, text, text, text, boolean, boolean, boolean, boolean, references,
                       size, handle, LOGGER, handle)
enter = function('fmi3EnterInitializationMode', ctypes.c_int, handle, boolean, real, real, boolean, real)
leave = function('fmi3ExitInitializationMode', ctypes.c_int, handle)
step = function('fmi3DoStep', ctypes.c_int, handle, real, real, boolean, ctypes.POINTER(boolean), ctypes.POINTER(boolean),
                ctypes.POINTER(boolean), ctypes.POINTER(real))
get = function('fmi3GetFloat64', ctypes.c_int, handle, references, size, ctypes.POINTER(real), size)
set_value = function('fmi3SetFloat64', ctypes.c_int, handle, references, size, ctypes.POINTER(real), size)
get_whole = function('fmi3GetUInt64', ctypes.c_int, handle, references, size, ctypes.POINTER(ctypes.c_uint64), size)
get_clock = function('fmi3GetClock', ctypes.c_int, handle, references, size, ctypes.POINTER(boolean))
enter_event = function('fmi3EnterEventMode', ctypes.c_int, handle)
enter_step = function('fmi3EnterStepMode', ctypes.c_int, handle)
update = function('fmi3UpdateDiscreteStates', ctypes.c_int, handle, *[ctypes.POINTER(boolean)] * 5, ctypes.POINTER(real))
terminate = function('fmi3Terminate', ctypes.c_int, handle)
free = function('fmi3FreeInstance', None, handle)


def value(name):
    out = real()
    if get(instance, ctypes.byref(ctypes.c_uint32(reference[name])), 1, ctypes.byref(out), 1) != 0:
        check('get ' + name, False)
    return out.value


check('version ' + function('fmi3GetVersion', text)().decode(), function('fmi3GetVersion', text)() == b'3.0')
token = root.get('instantiationToken').encode()
instance = instantiate(b'rig', token, (folder + '/resources/').encode(), False, False, False, False, None, 0, None, logger, None)
check('an instance', bool(instance))
check('initialization', enter(instance, False, 0.0, 0.0, True, 0.5) == 0 and leave(instance) == 0)
rows = subprocess.run([program, 'simulate', 'rig', '--method', 'taylor', '--tol', '1e-12', '--until', '0.5', '--every', '0.001'],
                      capture_output=True, text=True, check=True).stdout.split()
event, end, early, last = boolean(True), boolean(True), boolean(True), real()
largest = error = 0.0
good = True
for i, row in enumerate(rows[1:]):
    want = [float(x) for x in row.split(',')]
    largest = max(largest, abs(want[1]))
    error = max(error, abs(value('displacement') - want[1]), abs(value('penetration') - want[3]))
    if i < 500:
        good = good and step(instance, i * 0.001, 0.001, True, ctypes.byref(event), ctypes.byref(end), ctypes.byref(early),
                             ctypes.byref(last)) == 0 and abs(last.value - (i + 1) * 0.001) < 1e-12
check('500 steps, no event, no end, no early return', good and not (event.value or end.value or early.value))
check('%d rows of simulate: largest difference %.2g of a motion of %.2g m, allowed 1e-7 of it' % (len(rows) - 1, error, largest),
      len(rows) == 502 and error < 1e-7 * largest)
check('beyond the stop time: an error with a text', step(instance, 0.5, 0.001, True, ctypes.byref(event), ctypes.byref(end),
                                                         ctypes.byref(early), ctypes.byref(last)) == 3 and len(messages) == 1
      and messages[0][0] == 3 and b'beyond the stop time' in messages[0][2])
check('the end', terminate(instance) == 0)
free(instance)


def reference_of(name):
    return ctypes.byref(ctypes.c_uint32(reference[name]))


def touchdown():
    """Event mode, once through: whether the clock ticked, contact switches so far."""
    ticks, flags, time, switches = boolean(), [boolean(True) for _ in range(5)], real(), ctypes.c_uint64()
    good = enter_event(instance) == 0 and get_clock(instance, reference_of('contact'), 1, ctypes.byref(ticks)) == 0
    good = good and get_whole(instance, reference_of('contact_switches'), 1, ctypes.byref(switches), 1) == 0
    good = good and update(instance, *map(ctypes.byref, flags), ctypes.byref(time)) == 0 and enter_step(instance) == 0
    return good and ticks.value and not any(f.value for f in flags), switches.value


capable = root.find('CoSimulation')
check('event mode and early return are announced, with a triggered clock',
      (capable.get('hasEventMode'), capable.get('mightReturnEarlyFromDoStep')) == ('true', 'true')
      and [(v.tag, v.get('intervalVariability')) for v in root.find('ModelVariables') if v.get('name') == 'contact'] == [('Clock', 'triggered')])
instance = instantiate(b'rig', token, (folder + '/resources/').encode(), False, False, True, True, None, 0, None, logger, None)
check('an instance with event mode', bool(instance) and enter(instance, False, 0.0, 0.0, False, 0.0) == 0 and leave(instance) == 0)
check('shaken, and on to step mode', set_value(instance, reference_of('drive.force.amplitude'), 1, ctypes.byref(real(60.0)), 1) == 0
      and enter_step(instance) == 0)
now, n, closed, deepest = 0.0, 0, True, 0.0
while now < 0.5:
    if step(instance, now, 0.5 - now, True, ctypes.byref(event), ctypes.byref(end), ctypes.byref(early), ctypes.byref(last)) != 0:
        check('a step', False)
        break
    now = last.value
    if early.value:
        n += 1
        deepest = max(deepest, value('penetration') / abs(value('velocity')))
        ticked, switches = touchdown()
        closed = closed and event.value and ticked and switches == 2 * n and value('in_contact') == 1.0 and value('penetration') >= 0.0
check('%d touchdowns in 0.5 s: at each the clock ticks, and the contact has opened and closed once more' % n, closed and n >= 20)
check('depth at a touchdown by speed: at most %.2g s, allowed 1e-9' % deepest, deepest < 1e-9)
check('the end', terminate(instance) == 0)
free(instance)
sys.exit(failed > 0)
