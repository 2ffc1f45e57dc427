"""test_rig.py - a plant and a controller in a test suite of your own: 20 cases.

    PYTHONPATH=$(pkg-config --variable=python contactplant) pytest test_rig.py"""
import math

import contactplant
import pytest
from contactplant import lockstep, plant  # noqa: F401, fixtures

MASS_KG, STIFFNESS, PRELOAD_N, DAMPING = 6.5, 3.4e9, 64.0, 188.0  # of hertz_rig: F = STIFFNESS z^1.5
SLOPE = 1.5 * STIFFNESS ** (2 / 3) * PRELOAD_N ** (1 / 3)  # N/m, of the contact under its preload
RESONANCE_HZ = math.sqrt(SLOPE / MASS_KG) / (2 * math.pi)


def controller(force_N, in_contact):
    """It is what is tested here: it presses when the contact opens, and lets go slowly."""
    return 0.999 * force_N if in_contact else min(force_N + 1.0, 40.0)


@pytest.mark.parametrize("preload_N", [16.0, 64.0, 256.0])
def test_rests_where_hertz_says(preload_N):
    rig = contactplant.Plant(f"[plant]\nmodel = hertz_rig\npreload = {preload_N} N\n")
    rig.advance_to(1.0)
    assert rig.output("penetration") == pytest.approx((preload_N / STIFFNESS) ** (2 / 3), rel=1e-9)


@pytest.mark.parametrize("force_N", [0.1, 0.2, 0.5])
def test_keeps_contact_when_shaken_gently(plant, force_N):
    plant.drive("force", force_N, RESONANCE_HZ, ramp_s=0.1)
    plant.advance_to(0.5)
    assert plant.counter("switches") == 0


@pytest.mark.parametrize("force_N", [5.0, 10.0, 20.0])
def test_loses_contact_when_shaken_hard(plant, force_N):
    plant.drive("force", force_N, 0.98 * RESONANCE_HZ, ramp_s=0.1)
    plant.advance_to(0.5)
    events = plant.events()
    assert plant.counter("switches") == len(events) + plant.counter("events_lost") > 0
    assert all(a.time_s < b.time_s and a.touch != b.touch for a, b in zip(events, events[1:]))
    assert abs(plant.residual) < 1e-3 * plant.energy


@pytest.mark.parametrize("ratio", [0.2, 0.7, 1.4])
def test_small_motion_is_that_of_a_linear_spring(plant, ratio):
    plant.drive("force", 0.01, ratio * RESONANCE_HZ, ramp_s=0.1)
    plant.advance_to(2.0)
    rest, largest, omega = (PRELOAD_N / STIFFNESS) ** (2 / 3), 0.0, 2 * math.pi * ratio * RESONANCE_HZ
    for _ in range(100 * 64):
        plant.advance(1)
        largest = max(largest, abs(plant.output("displacement") - rest))
    assert largest == pytest.approx(0.01 / math.hypot(SLOPE - MASS_KG * omega**2, DAMPING * omega), rel=1e-2)


@pytest.mark.parametrize("plant", ["rig", "tip", "shaft"], indirect=True)
def test_goes_on_from_saved_bytes(plant):  # noqa: F811
    saved = plant.save()
    plant.run(20)
    hash = plant.hash
    plant.restore(saved)
    plant.run(20)
    assert plant.hash == hash


def test_controller_in_a_loop(plant, force_N=0.0):
    plant.drive("force", 3.0, 225.0, ramp_s=0.1)
    for _ in range(1000):
        force_N = controller(force_N, plant.output("in_contact"))
        plant.sample("force", force_N)
        plant.run(1)
    assert plant.counter("switches") < 200 and 1.0 < force_N < 40.0


@pytest.fixture(params=["in memory", "over UDP"])
def me(request):
    if request.param == "over UDP":
        return request.getfixturevalue("lockstep")
    client = contactplant.Client("hertz_rig", contactplant.App("hertz_rig"))
    client.begin()
    return client


def test_controller_on_a_bus(me, force_N=0.0):
    me.start()
    me.arm("force", 3.0, 225.0, ramp_s=0.1)
    me.fire("force", tick=me.latest.tick + 20 * me.plant.substeps)
    for _ in range(1000):
        me.wait_contact(me.latest.contact_tick + 1)
        force_N = controller(force_N, me.latest.in_contact)
        me.stream("force", me.latest.contact_tick // me.plant.substeps + 1, force_N)
        me.heartbeat()
    me.stop()
    assert me.latest.refused == 0 and 0 < me.latest.touchdowns < 200


@pytest.mark.parametrize("line", ["mas = 5 kg", "mass = 5 N"])
def test_a_mistake_in_a_scene_names_its_line(line):
    with pytest.raises(contactplant.Error, match="scene:3: mass?"):
        contactplant.Plant(f"[plant]\nmodel = hertz_rig\n{line}\n")
