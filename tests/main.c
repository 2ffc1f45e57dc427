/* main.c - runs every test, or those whose name contains an argument; last line `N passed, N failed`. */
#include "tests/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "firmware/check.h"

static int n_passed, n_failed;

static void verdict(int ok)
{
    n_passed += ok;
    n_failed += !ok;
    fflush(stdout);
}

void check_true(const char *name, int condition)
{
    printf("%s  %s\n", condition ? "ok  " : "FAIL", name);
    verdict(condition != 0);
}

void check_near(const char *name, double got, double expected, double tolerance)
{
    int ok = fabs(got - expected) <= tolerance;
    printf("%s  %s: %.12g, expected %.12g, off by %.2g (allowed %.2g)\n", ok ? "ok  " : "FAIL", name, got,
           expected, got - expected, tolerance);
    verdict(ok);
}

void check_below(const char *name, double got, double limit)
{
    int ok = got <= limit;
    printf("%s  %s: %.6g, at most %.6g\n", ok ? "ok  " : "FAIL", name, got, limit);
    verdict(ok);
}

void check_above(const char *name, double got, double limit)
{
    int ok = got >= limit;
    printf("%s  %s: %.6g, at least %.6g\n", ok ? "ok  " : "FAIL", name, got, limit);
    verdict(ok);
}

void check_int(const char *name, int64_t got, int64_t expected)
{
    int ok = got == expected;
    printf("%s  %s: %lld, expected %lld\n", ok ? "ok  " : "FAIL", name, (long long)got, (long long)expected);
    verdict(ok);
}

void check_hex(const char *name, uint64_t got, uint64_t expected)
{
    int ok = got == expected;
    printf("%s  %s: %016llx, expected %016llx\n", ok ? "ok  " : "FAIL", name, (unsigned long long)got,
           (unsigned long long)expected);
    verdict(ok);
}

void check_string(const char *name, const char *got, const char *expected)
{
    int ok = got && expected && strcmp(got, expected) == 0;
    printf("%s  %s: \"%s\", expected \"%s\"\n", ok ? "ok  " : "FAIL", name, got ? got : "(null)",
           expected ? expected : "(null)");
    verdict(ok);
}

/* One line per test function; the order is from the ground floor up. */
/* clang-format off */
#define TEST_LIST(X) \
    X(elementary_turns) \
    X(elementary_cos_sin) \
    X(elementary_phase) \
    X(elementary_arc_tangent) \
    X(elementary_exponential) \
    X(elementary_logarithm) \
    X(elementary_cube_root) \
    X(soft_sqrt_special) \
    X(soft_sqrt_exponents) \
    X(soft_sqrt_random) \
    X(soft_sqrt_halfway) \
    X(drive_phase_exact) \
    X(drive_ramp) \
    X(drive_ramp_fraction) \
    X(drive_ramp_interrupted) \
    X(drive_start_phase) \
    X(drive_samples) \
    X(drive_random_walk) \
    X(drive_parts_of_a_tick) \
    X(drive_bookkeeping) \
    X(noise_words) \
    X(noise_inverse) \
    X(noise_moments) \
    X(noise_distribution) \
    X(noise_correlation) \
    X(noise_grid) \
    X(noise_any_start) \
    X(noise_ramp) \
    X(noise_and_harmonic) \
    X(noise_new_parameters) \
    X(noise_change) \
    X(noise_parts_of_a_tick) \
    X(noise_spectrum) \
    X(noise_methods_hertz) \
    X(noise_methods_linear) \
    X(noise_order) \
    X(noise_covariance) \
    X(noise_density) \
    X(noise_rolling_contact) \
    X(papers_folds) \
    X(papers_peaks) \
    X(papers_responses) \
    X(papers_jumps) \
    X(papers_theory) \
    X(papers_contact) \
    X(papers_shaft) \
    X(papers_survival) \
    X(papers_exponents) \
    X(papers_impacting) \
    X(papers_unison) \
    X(papers_one_mode_averaged) \
    X(papers_one_mode_integrated) \
    X(papers_one_mode_figures) \
    X(papers_reference) \
    X(papers_attractors) \
    X(papers_table) \
    X(excitation_split) \
    X(switch_crossing) \
    X(switch_first_of_many) \
    X(switch_grazing) \
    X(switch_hollow) \
    X(switch_ends) \
    X(switch_cheap_test_is_safe) \
    X(switch_sharpened) \
    X(switch_locate_lines) \
    X(switch_locate_rounding) \
    X(switch_locate_jump) \
    X(switch_locate_touch) \
    X(switch_locate_contacts) \
    X(switch_locate_order) \
    X(switch_locate_back) \
    X(ledger_sums) \
    X(ledger_works) \
    X(ledger_order) \
    X(ledger_residual) \
    X(ledger_spoiled_method) \
    X(ledger_free_vibration) \
    X(ledger_start) \
    X(ledger_few_ticks) \
    X(ledger_short_piece) \
    X(ledger_small_pieces) \
    X(plant_instants) \
    X(plant_fractions) \
    X(plant_step_by_step) \
    X(plant_step_response) \
    X(plant_forced_response) \
    X(plant_dilation) \
    X(plant_units) \
    X(plant_drive_start) \
    X(plant_set_state) \
    X(plant_reset) \
    X(plant_loss_time) \
    X(plant_events) \
    X(plant_switch_at_tick_end) \
    X(plant_inputs_after_switch) \
    X(plant_peak_force) \
    X(plant_grazing) \
    X(plant_soak) \
    X(plant_change) \
    X(plant_change_refused) \
    X(plant_change_loss_time) \
    X(plant_init_refusals) \
    X(plant_check) \
    X(plant_budget) \
    X(plant_method_budget) \
    X(plant_not_finite) \
    X(plant_far) \
    X(plant_silence) \
    X(models_tables) \
    X(models_rest) \
    X(models_paper_state) \
    X(models_energy) \
    X(models_linear_view) \
    X(models_hertz_form) \
    X(models_polynomial_form) \
    X(models_rk4_instances) \
    X(models_one_input) \
    X(models_refused) \
    X(models_units) \
    X(models_scale) \
    X(models_ranges) \
    X(models_tip_si) \
    X(models_tip_saddle) \
    X(models_rolling_and_rig) \
    X(models_rung_of_rung) \
    X(models_settings) \
    X(models_rig_equations) \
    X(models_rolling_equations) \
    X(models_tip_equations) \
    X(models_rig_averaged) \
    X(models_rig_averaged_numbers) \
    X(models_tip_averaged) \
    X(models_tip_averaged_numbers) \
    X(models_output_rig) \
    X(models_output_rolling) \
    X(models_output_tip) \
    X(models_output_shaft) \
    X(models_contact_loss) \
    X(models_shaft_frequencies) \
    X(models_shaft_damping) \
    X(models_shaft_eigenfrequency) \
    X(models_shaft_equation) \
    X(models_shaft_regimes) \
    X(models_shaft_modes) \
    X(models_symmetric3) \
    X(rig_scale) \
    X(rig_free_period) \
    X(rig_contact_loss) \
    X(rig_mean_force) \
    X(rig_power_balance) \
    X(rig_order) \
    X(rig_bounce) \
    X(reference_trajectories) \
    X(lockin_closed_form) \
    X(lockin_windows) \
    X(lockin_leakage) \
    X(lockin_mean) \
    X(lockin_chirp) \
    X(lever_amplitude) \
    X(capture_exhaustive) \
    X(capture_refusals) \
    X(capture_triggers) \
    X(capture_read) \
    X(timing_histogram) \
    X(mailbox_fires) \
    X(mailbox_samples) \
    X(mailbox_random) \
    X(mailbox_staged) \
    X(wire_crc) \
    X(wire_golden) \
    X(wire_round_trip) \
    X(wire_limits) \
    X(wire_refusals) \
    X(wire_flipped_bits) \
    X(wire_bursts) \
    X(wire_layouts) \
    X(wire_lsb) \
    X(settings_table) \
    X(diag_names) \
    X(app_state_table) \
    X(app_session) \
    X(app_stranger) \
    X(app_enable_age) \
    X(app_complement) \
    X(app_stop_always) \
    X(app_outage_queue) \
    X(app_outage_of_plant) \
    X(app_repeated) \
    X(app_late_horizon) \
    X(app_age_while_frozen) \
    X(app_forgets) \
    X(app_bad_frames) \
    X(app_fire_exact) \
    X(app_fire_together) \
    X(app_fire_change) \
    X(app_fire_impulse) \
    X(app_fire_order) \
    X(app_fire_full) \
    X(app_fire_refused) \
    X(app_noise_fire) \
    X(app_noise_fields) \
    X(app_noise_refused) \
    X(app_noise_stop) \
    X(app_noise_timeout) \
    X(app_noise_same) \
    X(sensor_none) \
    X(sensor_offset) \
    X(sensor_noise) \
    X(sensor_stuck) \
    X(sensor_saturation) \
    X(sensor_quantum) \
    X(sensor_delay) \
    X(sensor_skipped) \
    X(sensor_order) \
    X(sensor_not_available) \
    X(sensor_truth) \
    X(sensor_reset) \
    X(sensor_refused) \
    X(app_stream_hold) \
    X(app_stream_linear) \
    X(app_stream_guards) \
    X(app_stream_wrap) \
    X(app_stream_full) \
    X(app_timeout_frame) \
    X(app_timeout_hold) \
    X(app_timeout_ramp) \
    X(app_timeout_zero) \
    X(app_timeout_freeze) \
    X(app_parameters_now) \
    X(app_parameters_refused) \
    X(app_parameters_guard) \
    X(app_parameters_fire) \
    X(app_parameters_two_fires) \
    X(app_parameters_overtaken) \
    X(app_parameters_ledger) \
    X(app_parameters_settings) \
    X(app_parameters_echo) \
    X(app_capture_liftoff) \
    X(app_capture_fire) \
    X(app_capture_refused) \
    X(app_lockin_sum) \
    X(app_lockin_linear) \
    X(app_lockin_own_windows) \
    X(watch_tick) \
    X(watch_inputs) \
    X(watch_limits) \
    X(watch_numbers) \
    X(watch_eigenfrequency) \
    X(watch_eigenfrequency_fire) \
    X(watch_time) \
    X(watch_bus) \
    X(watch_silent) \
    X(watch_climb) \
    X(watch_climb_energy) \
    X(watch_climb_refused) \
    X(watch_climb_bus) \
    X(watch_climb_parameters) \
    X(watch_scene) \
    X(watch_scene_angular) \
    X(watch_changes_fire) \
    X(watch_changes_kinds) \
    X(watch_changes_stop) \
    X(watch_changes_reset) \
    X(watch_changes_timeout) \
    X(watch_changes_none) \
    X(watch_changes_climb) \
    X(watch_changes_scene) \
    X(watch_drive_frequency) \
    X(watch_drive_frequency_most) \
    X(watch_drive_frequency_bus) \
    X(watch_drive_frequency_scene) \
    X(app_report_motion) \
    X(app_report_events) \
    X(app_report_flood) \
    X(app_report_summary) \
    X(app_report_hash) \
    X(app_report_latency) \
    X(app_report_echo) \
    X(app_report_health) \
    X(app_report_pressure) \
    X(app_report_kinds) \
    X(app_room_capture) \
    X(app_room_lockin) \
    X(app_room_echo) \
    X(app_room_outage) \
    X(app_time_steps) \
    X(app_time_until) \
    X(app_time_telemetry) \
    X(app_time_pause) \
    X(app_time_snapshot) \
    X(app_time_overrun) \
    X(app_time_overrun_limit) \
    X(app_time_overrun_longest) \
    X(app_time_overrun_echo) \
    X(app_time_overrun_stepping) \
    X(app_two_plants) \
    X(app_extended) \
    X(app_not_finite) \
    X(app_not_finite_frame) \
    X(app_ledger_alarm) \
    X(app_switch_budget) \
    X(app_bound_switches) \
    X(app_bound_method) \
    X(app_ledger_quiet) \
    X(app_fault_capture) \
    X(app_last_run) \
    X(cmsdk_watchdog_fed) \
    X(cmsdk_watchdog_starved) \
    X(cmsdk_watchdog_locked) \
    X(app_delay_velocity) \
    X(app_delay_displacement) \
    X(taylor_contact_series) \
    X(taylor_flight_series) \
    X(taylor_regular_series) \
    X(taylor_polynomial_series) \
    X(taylor_load_move) \
    X(taylor_root) \
    X(taylor_evaluation) \
    X(taylor_commands) \
    X(taylor_short) \
    X(taylor_short_cubic) \
    X(taylor_short_flight) \
    X(taylor_short_lift_off) \
    X(taylor_short_orders) \
    X(taylor_short_worth) \
    X(taylor_short_inputs) \
    X(taylor_brief) \
    X(taylor_zero_length) \
    X(taylor_reuse) \
    X(taylor_snapshot) \
    X(taylor_parameter_change) \
    X(taylor_set_state) \
    X(taylor_grazing) \
    X(taylor_budget) \
    X(taylor_escape) \
    X(taylor_refusals) \
    X(taylor_switch_at_start) \
    X(taylor_near_zero) \
    X(taylor_reference) \
    X(taylor_tolerance) \
    X(rk4_float32_step) \
    X(rk4_float32_mirrored) \
    X(rk4_float32_zero_step) \
    X(rk4_float32_not_finite) \
    X(rk4_float32_refusals) \
    X(rk4_float32_smooth) \
    X(rk4_float32_order) \
    X(rk4_float32_long) \
    X(rk4_float32_energy) \
    X(rk4_float32_detuning) \
    X(rk4_float32_reference) \
    X(rk4_float32_contact_order) \
    X(rk4_float32_ledger) \
    X(rk4_unlocated_bits) \
    X(rk4_unlocated_events) \
    X(rk4_unlocated_together) \
    X(rk4_unlocated_told_through) \
    X(rk4_unlocated_order_hertz) \
    X(rk4_unlocated_order_gap) \
    X(rk4_unlocated_refusals) \
    X(exact_free) \
    X(exact_parts) \
    X(exact_damped) \
    X(exact_resonance) \
    X(exact_bounce) \
    X(exact_grazing) \
    X(exact_double_turn) \
    X(exact_refusal) \
    X(exact_far) \
    X(exact_any) \
    X(exact_shaft_reference) \
    X(exact_shaft_chatter) \
    X(exact_shaft_together) \
    X(exact_shaft_modes) \
    X(exact_waves) \
    X(exact_waves_contact) \
    X(exact_plant_drives) \
    X(exact_state_set) \
    X(exact_parameter_change) \
    X(exact_snapshot) \
    X(order_periods) \
    X(order_kink) \
    X(order_tolerance) \
    X(order_exact) \
    X(order_multipliers) \
    X(order_tongues) \
    X(order_drive) \
    X(tolerance_small) \
    X(tolerance_anew) \
    X(tolerance_drives) \
    X(auto_choice) \
    X(auto_tolerance) \
    X(auto_refusals) \
    X(auto_bits) \
    X(auto_change) \
    X(auto_bus) \
    X(chatter_dense) \
    X(energy_free) \
    X(energy_grazing) \
    X(energy_contact) \
    X(energy_bounces) \
    X(energy_contact_time) \
    X(identities_rig) \
    X(identities_rolling) \
    X(identities_tip) \
    X(identities_shaft) \
    X(batch_series) \
    X(batch_root) \
    X(batch_cos_sin) \
    X(batch_reference) \
    X(batch_rk4) \
    X(batch_rk4_plant) \
    X(batch_rk4_split) \
    X(batch_rk4_escape) \
    X(batch_rk4_refusals) \
    X(batch_company) \
    X(batch_kernels) \
    X(batch_events) \
    X(batch_grazing) \
    X(batch_escape) \
    X(batch_budget) \
    X(batch_many) \
    X(batch_refusals) \
    X(selftest_passes) \
    X(selftest_expected) \
    X(selftest_models) \
    X(selftest_method) \
    X(selftest_stops) \
    X(selftest_small_image) \
    X(selftest_hash_switches) \
    X(selftest_report) \
    X(selftest_refuses) \
    X(loopback_order) \
    X(loopback_full) \
    X(can_frames) \
    X(can_filter) \
    X(can_transmit_full) \
    X(can_receive_overrun) \
    X(can_hostile_frames) \
    X(can_error_states) \
    X(can_bus_off) \
    X(can_stays_off) \
    X(can_upset) \
    X(can_stuck) \
    X(can_refuses_configuration) \
    X(xilinx_can_registers) \
    X(xilinx_can_words) \
    X(xilinx_can_start) \
    X(xilinx_can_events) \
    X(sja1000_registers) \
    X(sja1000_bytes) \
    X(sja1000_queues) \
    X(sja1000_recovery) \
    X(cannelloni_packet) \
    X(cannelloni_room) \
    X(cannelloni_malformed) \
    X(ipv4_checksum) \
    X(ipv4_datagram) \
    X(ipv4_refused) \
    X(ipv4_truncated) \
    X(ipv4_random) \
    X(ipv4_arp) \
    X(net_config) \
    X(net_resolve) \
    X(net_exchange) \
    X(net_strangers) \
    X(net_full) \
    X(net_flood) \
    X(lan9118_settings) \
    X(lan9118_receives) \
    X(lan9118_damage) \
    X(lan9118_loss) \
    X(lan9118_sends) \
    X(lan9118_no_room) \
    X(lan9118_refuses) \
    X(stm32_fdcan_registers) \
    X(stm32_fdcan_elements) \
    X(stm32_fdcan_filter) \
    X(stm32_fdcan_fifos) \
    X(stm32_fdcan_modes) \
    X(stm32_fdcan_fd) \
    X(stm32_fdcan_exceptions) \
    X(stm32_fdcan_stuck_bits) \
    X(stm32_fdcan_bus_off) \
    X(stm32_fdcan_memory_failure) \
    X(stm32_fdcan_refuses) \
    X(udp_addresses) \
    X(udp_exchange) \
    X(udp_strangers) \
    X(udp_batching) \
    X(udp_kernel_full) \
    X(udp_overflow) \
    X(udp_peer_not_up) \
    X(udp_receive_errors) \
    X(log_golden) \
    X(log_parse) \
    X(log_refused) \
    X(log_record) \
    X(log_full_disk) \
    X(log_disk_fills_up) \
    X(log_cut_off) \
    X(replay_frames) \
    X(replay_differences) \
    X(replay_run) \
    X(replay_tampered) \
    X(replay_on_bus) \
    X(replay_on_bus_unanswered) \
    X(replay_on_bus_answered) \
    X(replay_on_bus_doubt) \
    X(replay_on_bus_refused) \
    X(replay_on_bus_others) \
    X(scene_units) \
    X(scene_unit_round_trip) \
    X(scene_mistakes) \
    X(scene_limits) \
    X(scene_round_trip) \
    X(scene_watch) \
    X(scene_garbage) \
    X(scenes_presets) \
    X(scenes_default) \
    X(scenes_begin) \
    X(scenes_figures) \
    X(scenes_warnings) \
    X(choose_costs) \
    X(choose_ladder) \
    X(choose_facts) \
    X(choose_repeats) \
    X(choose_watch) \
    X(choose_watch_step) \
    X(choose_watch_mode) \
    X(choose_watch_gap) \
    X(choose_watch_lost) \
    X(choose_watch_time) \
    X(choose_watch_averaged) \
    X(choose_watch_slow_drive) \
    X(choose_watch_third) \
    X(choose_watch_changes) \
    X(choose_watch_asymmetry) \
    X(choose_watch_sweep) \
    X(choose_watch_rest) \
    X(choose_watch_guards) \
    X(choose_growth) \
    X(choose_beyond_linear) \
    X(choose_beyond_paper) \
    X(choose_beyond_touch) \
    X(choose_beyond_symmetry) \
    X(choose_beyond_none) \
    X(choose_beyond_cost) \
    X(choose_refusals) \
    X(choose_balance) \
    X(choose_refuse_amplitude) \
    X(choose_refuse_gap) \
    X(choose_refuse_fast) \
    X(choose_refuse_leaves_out) \
    X(choose_refuse_floquet) \
    X(choose_refuse_modes) \
    X(choose_refuse_step) \
    X(choose_refuse_swept) \
    X(choose_sweep_back) \
    X(choose_sweep) \
    X(choose_reference) \
    X(chart_ticks) \
    X(chart_range) \
    X(chart_gaps) \
    X(plant_bounds) \
    X(plant_bounds_drive) \
    X(plant_bounds_noise) \
    X(plant_bounds_parameters) \
    X(plant_bounds_inputs) \
    X(drive_change_phase) \
    X(drive_change_target) \
    X(drive_change_begin) \
    X(drive_change_long) \
    X(drive_change_rescale) \
    X(faults_none) \
    X(faults_chances) \
    X(faults_damage) \
    X(faults_times) \
    X(faults_together) \
    X(faults_bus_off) \
    X(faults_refuse) \
    X(faults_seed) \
    X(faults_queue) \
    X(faults_list) \
    X(faults_thousand_seeds) \
    X(faults_nth_call) \
    X(faults_stalled_link) \
    X(client_close) \
    X(client_open) \
    X(client_counts) \
    X(client_low_bits) \
    X(soak_session) \
    X(app_refusals_config) \
    X(app_refusals_settings) \
    X(special_encode) \
    X(special_commands) \
    X(special_parameters) \
    X(special_settings) \
    X(special_scenes) \
    X(app_refusals_inputs) \
    X(app_refusals_control) \
    X(app_refusals_capture) \
    X(app_refusals_fire_after_climb) \
    X(app_refusals_trouble_before_fire) \
    X(app_refusals_step_after_skip) \
    X(exact_edges_two_masses) \
    X(exact_edges_far) \
    X(exact_edges_refusal) \
    X(exact_edges_forced) \
    X(exact_edges_any_bound) \
    X(exact_edges_roots) \
    X(exact_edges_no_root) \
    X(refusals_names) \
    X(refusals_models) \
    X(refusals_longest_ramp) \
    X(refusals_noise_start) \
    X(refusals_faults) \
    X(refusals_log) \
    X(refusals_replay) \
    X(refusals_links) \
    X(jobs_order) \
    X(jobs_shards) \
    X(jobs_resume) \
    X(jobs_other_file) \
    X(jobs_changed) \
    X(jobs_locked) \
    X(jobs_gaps) \
    X(jobs_trouble) \
    X(jobs_pieces) \
    X(maps_books) \
    X(sweep_reference) \
    X(sweep_linear) \
    X(sweep_steep) \
    X(sweep_harmonics) \
    X(sweep_still) \
    X(sweep_unlocated) \
    X(sweep_escape) \
    X(sweep_resume) \
    X(sweep_shards) \
    X(sweep_meter_sums) \
    X(sweep_meter_extremes) \
    X(sweep_meter_order) \
    X(sweep_meter_brief) \
    X(sweep_meter_pairs) \
    X(basin_hypercube) \
    X(basin_wilson) \
    X(basin_returns) \
    X(basin_no_return) \
    X(basin_mirrors) \
    X(basin_rig) \
    X(basin_methods) \
    X(basin_shaft_705) \
    X(basin_shaft_pairs) \
    X(basin_shaft_reference) \
    X(basin_escape) \
    X(basin_forcing_period) \
    X(basin_plant_rig) \
    X(basin_plant_base) \
    X(basin_plant_tip) \
    X(basin_plant_shaft) \
    X(basin_plant_mode) \
    X(stability_tongues) \
    X(stability_plus_one) \
    X(stability_base) \
    X(stability_method) \
    X(stability_steps) \
    X(stability_linear) \
    X(stability_bounce) \
    X(random_nayak) \
    X(random_gauss) \
    X(random_no_law) \
    X(random_contact) \
    X(random_linear) \
    X(chart_well_formed)
/* clang-format on */

#define DECLARE(name) void test_##name(void);
TEST_LIST(DECLARE)
#define ROW(name) {#name, test_##name},
static const struct {
    const char *name;
    void (*run)(void);
} test[] = {TEST_LIST(ROW)};

/* Of a test that takes long its seconds of computing, too. */
static void run(int i)
{
    clock_t begin = clock();
    printf("--- %s\n", test[i].name);
    test[i].run();
    double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
    if (seconds >= 1.0)
        printf("      %s: %.1f s\n", test[i].name, seconds);
}

int main(int argc, char **argv)
{
    for (int i = 0; i < (int)(sizeof test / sizeof test[0]); i++)
        if (argc < 2 || strstr(test[i].name, argv[1]))
            run(i);
    printf("%d passed, %d failed\n", n_passed, n_failed);
    return n_failed != 0;
}
