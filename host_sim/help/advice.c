/* advice.c - see advice.h. */
#include "host_sim/help/advice.h"
#include "firmware/bus/diag.h"
#include "host_sim/cli/trouble.h"
#include "models/models.h"

#include <string.h>

#define COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

const char *const advice_list_name[ADVICE_LISTS] = {[ADVICE_FAULT] =
                                                        "fault, in FAULTS of STATUS, latched until a reset",
                                                    [ADVICE_CAUSE] = "cause of a refusal, in REPLY",
                                                    [ADVICE_COUNTER] = "counter, in HEALTH"};

#define VALUE "A value, no trouble. "

static const struct {
    const char *name, *text;
} table[] = {
    /* faults */
    {"not_finite", "The motion escaped: a force too large, a parameter of no rig, or a step too long. Lower "
                   "the drive, or take --method taylor or auto; then contactplant send reset."},
    {"budget", "A contact switched more often within a tick than the bound. Take shorter ticks (--substeps), "
               "or --method taylor."},
    {"ledger", "The integration makes or loses energy. Take shorter ticks or --method auto; contactplant "
               "choose says what keeps your tolerance."},
    {"overrun", "This machine was too slow for a frame, and --overrun stop ends the run then. See the "
                "counter overruns."},
    {"bus",
     "Look at cable, termination and bit rate, and whether the interface is up: ip -details link show can0."},
    {"timeout", "The controller sent no ENABLE for timeout_frames. Send it in each frame, or raise that "
                "setting; then open the next session."},
    {"assert", "The last run on the board ended by a fault of its own. HEALTH last_run says by which one; "
               "see contactplant help reference/boards."},
    {"self_test", "This build or board computes wrongly. SELF_TEST says which check failed; build with the "
                  "flags of the Makefile, and run contactplant selftest."},
    /* causes of refusals, and their counters */
    {"range", "Compare the value with its range: contactplant list models, contactplant list settings."},
    {"late", "The command came after the instant that it names. Name a later one, a few frames ahead of the "
             "last STATUS, or send it earlier."},
    {"stale", "The frame that the command echoes is older than age_limit_frames, or its instant is beyond "
              "horizon_frames. Echo the newest frame; look for a queue that delays."},
    {"session", "Use the session of STATUS. After a stop or a time-out open the next one by ENABLE: "
                "STATUS.SESSION % 15 + 1."},
    {"state", "Read STATE in STATUS first: step wants PAUSED, fire RUNNING or PAUSED, reset a plant that "
              "does not run. See contactplant help protocol."},
    {"full", "Wait for the replies before more is sent; ask for fewer samples of a burst."},
    {"incomplete", "Arm before you fire. For a set of parameters send all of them again, then COMMIT with "
                   "their count and CRC."},
    {"unknown", "Look the number up in contactplant help numbers. The controller may be for another model or "
                "version of the plant."},
    /* frames that are no command */
    {"crc", "Compute CHECKSUM as contactplant help protocol says, beside its test vectors. Or somebody else "
            "sends on the plant's identifiers: contactplant help neighbours."},
    {"length", "Each command has 8 bytes, those of unused fields too."},
    {"unknown_id", "Another device uses one of the plant's 64 identifiers. Move the plant by --base-id: "
                   "contactplant help neighbours."},
    {"counter_invalid", "COUNTER runs from 0 to 14; 15 is none."},
    {"repeated",
     "Count COUNTER up with each frame of one identifier. Two controllers on one plant cause this, too."},
    {"lost", "Frames were lost on their way, or the controller skips numbers of COUNTER. Look at the load of "
             "the bus and at rx_dropped."},
    {"frames_received",
     VALUE "Where it stands still, nothing reaches the plant: compare --bus, --peer and --base-id."},
    {"timeouts",
     "The controller was silent for timeout_frames. Send ENABLE in each frame, or raise that setting."},
    {"command_age_frames", VALUE "Where it grows, no ENABLE arrives: is the controller running?"},
    {"stream_missed",
     "The controller streams too slowly or irregularly. Send each sample a frame or two before it acts."},
    {"rx_dropped", "More frames came than the receive path could keep. Lower the load, or give the socket "
                   "more room: sysctl net.core.rmem_max."},
    {"rx_foreign", "Somebody who is no --peer sent to the plant's port, or a packet was none of ours. Add "
                   "him as --peer, or stop him."},
    {"bus_off", "The CAN controller left the bus after errors. Check bit rate, termination and cable; "
                "restart-ms lets it come back: ip link set can0 type can restart-ms 100."},
    {"bus_passive", "The CAN controller sees many errors. Check bit rate and termination, and that a second "
                    "node acknowledges."},
    {"bus_down", "The interface is down: ip link set can0 up."},
    {"tx_deferred", "The bus had no room for a while. Send fewer messages (settings *_every), or take a "
                    "faster bus; see contactplant help messages."},
    {"tx_replaced", "The bus had no room for so long that values were lost. Send fewer messages (settings "
                    "*_every), or take a faster bus."},
    {"rx_budget",
     "A frame brought as many commands as the plant takes. Spread them, or look for a sender in a loop."},
    {"rx_flood", "Somebody floods the plant; only STOP and ENABLE still pass. Find the sender: contactplant "
                 "monitor, candump."},
    {"tx_unsent", "A peer cannot be sent to. Does it listen on that port, and does a firewall stop packets?"},
    /* the plant */
    {"switches", VALUE "Contact switches that were located."},
    {"switch_budget",
     "A contact chatters. Take shorter ticks (--substeps), or more damping; the fault budget is set, too."},
    {"method_budget",
     "The method did not reach its tolerance within its bound. Loosen --tol, or take shorter ticks."},
    {"switch_residual",
     "The instants of these switches are less exact than usual. Take shorter ticks where they matter."},
    {"events_lost", "More contact events came than a frame reports. Read EVENT_SUMMARY for their number, or "
                    "take shorter frames (--rate)."},
    {"pieces_max", VALUE "Much more than 4 says that a contact chatters."},
    {"fire_applied", VALUE "Less than what was sent: look at the counters of refusals."},
    {"stream_applied", VALUE "Less than what was sent: look at stream_missed and late."},
    {"capture_state", VALUE "Where it stays 1, the trigger did not come: look at the settings capture_*."},
    {"capture_pretrigger", VALUE "Less than asked for: the trigger came soon after arming."},
    {"capture_tick", VALUE "The trigger of the burst stands at this tick."},
    {"watch_trips", "The watched observable left its interval: the reduced model no longer holds. Take the "
                    "full one, or run --promote."},
    {"watch_tick", VALUE "Motions from this tick on are outside of what the reduced model is good for."},
    {"sensor_faults",
     VALUE "A sensor fault was switched on by a setting: contactplant send set, INDEX 103 on."},
    {"lockin_short", "The window of the lock-in is shorter than a period of its tone. Raise lockin_frames."},
    {"lockin_close", "Two drives have nearly one frequency. Raise lockin_frames, or move one of them."},
    /* time */
    {"overruns", "This machine was too slow, or busy with others. Take a cheaper method (contactplant "
                 "choose), --realtime, or a slower plant (--dilation)."},
    {"frames_missed",
     "Frames were left out after an overrun. See overruns; --overrun says what happens then."},
    {"frames_slipped", "Plant time fell behind bus time. See overruns; --overrun catch_up makes it up."},
    {"compute_max_us", VALUE "Near the period of a frame: take a cheaper method, or a lower --rate."},
    {"compute_max_frame", VALUE "The frame in which compute_max_us was."},
    {"lateness_max_us", VALUE "Large beside a frame: the system starts the plant late. Take --realtime."},
    {"lateness_max_frame", VALUE "The frame in which lateness_max_us was."},
    {"last_run", "1 assert, 2 exception, 3 stack, 4 clock, 5 watchdog ended the board's last run. See "
                 "contactplant help reference/boards."},
    {"log_ended", "The disk is full, or --log-limit was reached: the recording ends before the run does. "
                  "Make room, or raise the limit."},
};

bool advice_named(enum advice_list list, int i, struct named *n)
{
    if (list == ADVICE_FAULT) {
        if (i < TROUBLE_FAULTS)
            *n = trouble_fault[i];
        return i < TROUBLE_FAULTS;
    }
    if (list == ADVICE_CAUSE) /* the first one is no refusal */
        return names_get(model_table[0], NAMES_CAUSE, (unsigned)i + 1, n);
    return names_get(model_table[0], NAMES_COUNTER, (unsigned)i, n);
}

const char *advice_text(const char *name)
{
    for (int i = 0; i < COUNT(table); i++)
        if (!strcmp(table[i].name, name))
            return table[i].text;
    return NULL;
}

const char *advice_name(int i)
{
    return i < COUNT(table) ? table[i].name : NULL;
}
