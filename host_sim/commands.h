/* commands.h - the subcommands of contactplant. argv[0] is the subcommand's name; the result is the exit
 * status. */
#ifndef HOST_SIM_COMMANDS_H
#define HOST_SIM_COMMANDS_H

enum { STATUS_DONE = 0, STATUS_FAILED = 1, STATUS_MISUSED = 2, STATUS_ESCAPED = 3, STATUS_SILENT = 4 };

int cmd_run(int argc, char **argv);
int cmd_simulate(int argc, char **argv);
int cmd_approach(int argc, char **argv);
int cmd_scan(int argc, char **argv);
int cmd_thermal(int argc, char **argv);
int cmd_sweep(int argc, char **argv);
int cmd_basin(int argc, char **argv);
int cmd_stability(int argc, char **argv);
int cmd_random(int argc, char **argv);
int cmd_merge(int argc, char **argv);
int cmd_send(int argc, char **argv);
int cmd_scope(int argc, char **argv);
int cmd_monitor(int argc, char **argv);
int cmd_control(int argc, char **argv);
int cmd_test(int argc, char **argv);
int cmd_replay(int argc, char **argv);
int cmd_decode(int argc, char **argv);
int cmd_compare(int argc, char **argv);
int cmd_list(int argc, char **argv);
int cmd_scene(int argc, char **argv);
int cmd_dbc(int argc, char **argv);
int cmd_dissector(int argc, char **argv);
int cmd_export(int argc, char **argv);
int cmd_selftest(int argc, char **argv);
int cmd_choose(int argc, char **argv);
int cmd_demo(int argc, char **argv);
int cmd_fmu(int argc, char **argv);
int cmd_fit(int argc, char **argv);
int cmd_help(int argc, char **argv);

#endif
