"""Builds that `make test` leaves to `make test-long`, while it runs other builds of the same blocks. Coverage
counts these builds too. Long tests of the tools that make evidence are listed with them."""

import os
from pathlib import Path

import pytest

os.environ.setdefault("MEISSNER_OPTIMISE", "-O1")  # before meissner.builds.toolchain reads it
# Each worker is a process: extra BLAS threads for small matrices wait for each other and double the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy reads it
os.environ.setdefault("MEISSNER_JOBS", "1")  # the workers of pytest use all cores

from harness import applicable, drawing, shared_builds

BIG = [
    "tb/actuate/test_actuate.py::test_actuate[parameters0]",
    "tb/actuate/test_grip.py::test_grip[parameters1]",
    "tb/boards/test_rows.py::test_rows[16-3]",
    "tb/boards/test_two_converters.py::test_two_converters[two]",
    "tb/boards/test_boards.py::test_the_smallest_board_synthesises_as_recorded",
    "tb/cli/test_cli.py::test_a_core_that_differs_from_its_twin_ends_the_run_with_an_error",
    "tb/cli/test_jobs.py::test_any_number_of_processes_gives_the_same[shear]",
    "tb/cli/test_jobs.py::test_any_number_of_processes_gives_the_same[rubber]",
    "tb/common/test_delay.py::test_delay[2]",
    "tb/common/test_delay.py::test_delay[4]",
    "tb/common/test_delay.py::test_delay[7]",
    "tb/common/test_divide.py::test_divide[34-7-2]",
    "tb/common/test_divide.py::test_divide[46-20-2]",
    "tb/common/test_frame_marker.py::test_frame_marker[2-1]",
    "tb/common/test_frame_marker.py::test_frame_marker[5-20]",
    "tb/common/test_frame_table.py::test_frame_table[128-1-1-2-5]",
    "tb/common/test_frame_table.py::test_frame_table[90-1-3-2-0]",
    "tb/common/test_multiply.py::test_multiply[17-16-common]",
    "tb/common/test_multiply.py::test_multiply[17-16-ecp5]",
    "tb/common/test_width_converter.py::test_width_converter[2-3-8]",
    "tb/common/test_width_converter.py::test_width_converter[3-5-1]",
    "tb/common/test_round_sat.py::test_round_sat[20-1-3-1]",
    "tb/common/test_round_sat.py::test_round_sat[9-9-1-0]",
    "tb/cop/test_cop_accumulate.py::test_cop_accumulate[11-1-1]",
    "tb/cop/test_cop_accumulate.py::test_cop_accumulate[3-3-1]",
    "tb/cop/test_cop_accumulate.py::test_cop_accumulate[64-64-1]",
    "tb/cop/test_cop_accumulate.py::test_cop_accumulate[1024-1024-8]",
    "tb/cop/test_cop_slip.py::test_cop_slip[1]",
    "tb/cop/test_cop.py::test_cop[1024-1024-8-14-1]",
    "tb/core/test_axis.py::test_axis[array-lane]",
    "tb/core/test_axis.py::test_axis[array-plain]",
    "tb/core/test_axis.py::test_axis[electrodes]",
    "tb/core/test_axis.py::test_axis[array-3]",
    "tb/core/test_core.py::test_core[channels]",
    "tb/core/test_core.py::test_core_of_a_stream[array]",
    "tb/core/test_grip_core.py::test_a_core_that_has_no_fingers_is_refused",
    "tb/core/test_stream_times.py::test_stream_times[five lanes]",
    "tb/core/test_stream_times.py::test_stream_times[taxels]",
    "tb/core/test_stream_times.py::test_stream_times[rows and columns]",
    "tb/core/test_left_out.py::test_what_is_left_out_is_not_elaborated[array64]",
    "tb/core/test_left_out.py::test_what_is_left_out_is_not_elaborated[cop4]",
    "tb/core/test_left_out.py::test_what_is_left_out_is_not_elaborated[full]",
    "tb/core/test_left_out.py::test_what_is_left_out_is_not_elaborated[slip1]",
    "tb/core/test_left_out.py::test_what_is_left_out_is_not_elaborated[display]",
    "tb/core/test_left_out.py::test_what_is_left_out_is_not_elaborated[fingertip]",
    "tb/core/test_latency.py::test_latency[parameters1]",
    "tb/core/test_latency.py::test_latency[parameters3]",
    "tb/core/test_latency.py::test_latency[parameters4]",
    "tb/core/test_latency.py::test_latency[parameters2]",
    "tb/core/test_shear_core.py::test_a_core_that_has_no_single_channels_is_refused",
    "tb/engines/test_core_engine.py::test_every_packet_is_the_models[full]",
    "tb/engines/test_core_engine.py::test_every_taxel_that_slips_is_reported[full]",
    "tb/engines/test_core_engine.py::test_every_taxel_that_slips_is_reported[array64]",
    "tb/engines/test_core_engine.py::test_the_line_tells_the_whole_slip[False]",
    "tb/engines/test_core_engine.py::test_every_packet_is_the_models[cop4]",
    "tb/engines/test_engines.py::test_any_number_of_channels[5]",
    "tb/engines/test_engines.py::test_any_number_of_channels[6]",
    "tb/engines/test_engines.py::test_any_number_of_channels[7]",
    "tb/engines/test_engines.py::test_any_number_of_channels[1024]",
    "tb/engines/test_engines.py::test_any_number_of_channels[120]",
    "tb/engines/test_engines.py::test_engines_agree[window64hop2level1]",
    "tb/engines/test_engines.py::test_engines_agree[window64hop64level2]",
    "tb/engines/test_engines.py::test_any_number_of_channels[4]",
    "tb/engines/test_engines.py::test_engines_agree[window64hop32level1]",
    "tb/engines/test_gate.py::test_the_gate_engine_is_the_integer_twin",
    "tb/engines/test_waves.py::test_an_arrays_frames_are_in_it[walk_25x5]",
    "tb/engines/test_waves.py::test_a_slip_runs_twenty_milliseconds",
    "tb/engines/test_waves.py::test_an_arrays_frames_are_in_it[plantar_step]",
    "tb/engines/test_waves.py::test_the_largest_array_stays_small",
    "tb/engines/test_waves.py::test_a_traced_core_that_differs_is_reported",
    "tb/engines/test_rail.py::test_a_code_at_the_rail_is_reported_railed[MCP3208-differential]",
    "tb/engines/test_rail.py::test_a_code_at_the_rail_is_reported_railed[AD7606-pulled_down]",
    "tb/engines/test_rail.py::test_a_code_at_the_rail_is_reported_railed[AD7606C-16-pulled_down]",
    "tb/engines/test_rail.py::test_a_code_at_the_rail_is_reported_railed[AD7606-differential]",
    "tb/engines/test_rail.py::test_a_code_at_the_rail_is_reported_railed[AD7606C-16-differential]",
    "tb/engines/test_gate_scenes.py::test_a_scene_as_a_whole_is_the_same_on_all_three",
    "tb/engines/test_driver_settings.py::test_latencies_at_the_pins[AD7606-3-51]",
    "tb/engines/test_driver_settings.py::test_latencies_at_the_pins[AD7606C-16-1-37]",
    "tb/engines/test_driver_settings.py::test_latencies_at_the_pins[MCP3208-1-38]",
    "tb/engines/test_driver_settings.py::test_latencies_at_the_pins[MCP3208-2-38]",
    "tb/engines/test_recordings.py::test_fixed_equals_rtl_in_every_field[level1blank0]",
    "tb/engines/test_recordings.py::test_fixed_equals_rtl_in_every_field[level3blank0]",
    "tb/engines/test_recordings.py::test_fixed_equals_rtl_in_every_field[level2blank0]",
    "tb/forest/test_budget.py::test_biotacsp_on_a_board[ulx3s-0.98]",
    "tb/forest/test_budget.py::test_biotacsp_on_a_board[icebreaker-0.9]",
    "tb/forest/test_forest_rtl.py::test_nine_of_ten_clocks_compare_a_node[8]",
    "tb/forest/test_forest.py::test_forest[outside]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-2-100000-14500-16]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-3-8000-14500]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-6-2-25000-14500]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-8-25000-14500]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-8-2-25000-14500]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-7-2-12500-14500-16]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[6-8-8-6000-60000]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[6-7-4-8000-60000]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[3-8-8000-16000]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[5-5-16000-6000]",
    "tb/frontend/test_adc_spi.py::test_adc_spi_with_triggers[1-2-25000-1000]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[1-8-8000-2000]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[6-2-2860-1000]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-5-2-100000-17000-1]",
    "tb/frontend/test_adc_spi.py::test_adc_spi[2-3-8000-14500-1-16]",
    "tb/frontend/test_calibrate.py::test_calibrate[64-64-1-17-0-1-12]",
    "tb/frontend/test_health.py::test_health[3-19-8-18]",
    "tb/frontend/test_health.py::test_health[64-64-8-17]",
    "tb/frontend/test_health.py::test_health[4-5-2-17]",
    "tb/frontend/test_health.py::test_health[3-3-1-17]",
    "tb/frontend/test_scan.py::test_scan[3-3-3-70-60-8-13]",
    "tb/frontend/test_scan.py::test_scan[5-14-4-2-80-6-16]",
    "tb/frontend/test_scan.py::test_scan[6-21-2-4-24-6]",
    "tb/frontend/test_scan.py::test_scan[8-8-1-8-20-6]",
    "tb/frontend/test_scan.py::test_scan[5-64-5-7-80-6-32]",
    "tb/frontend/test_scan.py::test_scan[5-14-4-2-80-6-16-79]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[16-16-2-8-25000]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[3-32-2-8-2-20000]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[4-15-7-4-2-41000]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[4-16-2-20000-32-1]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[8-8-3-8-25000]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[2-28-3-3-5-50000]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[3-32-2-8-2-2-100000-1]",
    "tb/frontend/test_scan_adc.py::test_scan_adc[3-14-6-7-2-4-8000-60000]",
    "tb/frontend/test_scan_demod.py::test_scan_demod[Rows2-Columns3-Converters2-Skip0]",
    "tb/frontend/test_scan_demod.py::test_scan_demod[Rows2-Columns3]",
    "tb/frontend/test_scan_demod.py::test_scan_demod[Rows2-Columns2-Form0-Shift1]",
    "tb/frontend/test_scan_demod.py::test_scan_demod[Rows2-Columns7-Converters3]",
    "tb/frontend/test_scan_plan.py::test_scan_plan[16-16-8-16-6-16]",
    "tb/frontend/test_scan_plan.py::test_scan_plan[6-17-8-1-9-9-8]",
    "tb/frontend/test_tare.py::test_tare[2-18-8-8-8]",
    "tb/frontend/test_tare.py::test_tare[3-3-1-1-1]",
    "tb/host/test_load.py::test_the_core_computes_what_was_loaded[True-3]",
    "tb/link/test_image_chunks.py::test_image_chunks[128-116]",
    "tb/link/test_packet.py::test_packet[2-0-128-116]",
    "tb/nightly/test_cover.py::test_a_small_block_has_no_hole",
    "tb/nightly/test_cover.py::test_sees_what_was_left_out",
    "tb/nightly/test_cover.py::test_a_waiver_takes_out_what_it_names",
    "tb/nightly/test_netlists.py::test_a_state_while_a_bit_is_0_is_a_condition",
    "tb/nightly/test_netlists.py::test_resets_hold_with_what_is_taken_for_granted[adc_store]",
    "tb/nightly/test_netlists.py::test_resets_hold_with_what_is_taken_for_granted[delay]",
    "tb/nightly/test_netlists.py::test_resets_hold_with_what_is_taken_for_granted[multiply]",
    "tb/nightly/test_netlists.py::test_resets_hold_with_what_is_taken_for_granted[uart_rx]",
    "tb/nightly/test_netlists.py::test_what_yosys_reads_otherwise_is_found",
    "tb/nightly/test_netlists.py::test_netlist_is_proven_and_so_is_the_reset[skid]",
    "tb/nightly/test_netlists.py::test_netlist_is_proven_and_so_is_the_reset[frame_gate]",
    "tb/nightly/test_netlists.py::test_wrong_wire_between_blocks_is_found[reset]",
    "tb/nightly/test_netlists.py::test_wrong_wire_between_blocks_is_found[inputs changed over]",
    "tb/nightly/test_faults.py::test_a_run_in_which_nothing_comes_out_is_refused",
    "tb/nightly/test_faults.py::test_finds_bytes_that_stay_wrong",
    "tb/nightly/test_faults.py::test_finds_damage_that_nobody_reports",
    "tb/nightly/test_faults.py::test_no_fault_is_undetected[frame_filter]",
    "tb/nightly/test_faults.py::test_no_fault_is_undetected[skid]",
    "tb/nightly/test_proofs.py::test_holds[grip]",
    "tb/nightly/test_proofs.py::test_holds[packet]",
    "tb/nightly/test_proofs.py::test_holds[scan_plan]",
    "tb/nightly/test_proofs.py::test_holds[fifo]",
    "tb/nightly/test_proofs.py::test_holds[frame_table]",
    "tb/nightly/test_proofs.py::test_holds[peak_to_peak]",
    "tb/nightly/test_proofs.py::test_holds[slip]",
    "tb/nightly/test_proofs.py::test_planted_bug_is_found[fifo]",
    "tb/nightly/test_proofs.py::test_holds[cobs]",
    "tb/nightly/test_proofs.py::test_holds[delay]",
    "tb/nightly/test_proofs.py::test_holds[frame_marker]",
    "tb/nightly/test_proofs.py::test_holds[pwm]",
    "tb/nightly/test_proofs.py::test_holds[scan]",
    "tb/nightly/test_proofs.py::test_holds[width_converter]",
    "tb/nightly/test_mutants.py::test_a_weak_test_leaves_survivors_that_the_solver_distinguishes",
    "tb/nightly/test_mutants.py::test_quick_blocks_kill_theirs[fork]",
    "tb/nightly/test_mutants.py::test_quick_blocks_kill_theirs[round_sat]",
    "tb/nightly/test_mutants.py::test_shows_equivalence_and_never_of_a_killed_mutant",
    "tb/nightly/test_mutants.py::test_quick_blocks_kill_theirs[skid]",
    "tb/nightly/test_mutants.py::test_quick_blocks_kill_theirs[sync]",
    "tb/physics/test_array_scenes.py::test_run[rtl-capacitive_cell]",
    "tb/physics/test_array_scenes.py::test_run[rtl-capacitive_select]",
    "tb/physics/test_array_scenes.py::test_run[rtl-fsr_3x3]",
    "tb/physics/test_report.py::test_every_scene_is_reported_verdict_first_and_in_words[shear_speed]",
    "tb/physics/test_report.py::test_every_scene_is_reported_verdict_first_and_in_words[rope_pull]",
    "tb/sensor/test_array_pins.py::test_array_pins[64x64 settled, four MAX11131]",
    "tb/sensor/test_array_pins.py::test_array_pins[64x64]",
    "tb/sensor/test_array_pins.py::test_array_pins[64x64 during]",
    "tb/sensor/test_array_pins.py::test_array_pins[demod]",
    "tb/sensor/test_array_pins.py::test_array_pins[4x10]",
    "tb/sensor/test_array_pins.py::test_array_pins[16x16]",
    "tb/sensor/test_array_pins.py::test_array_pins[3x16]",
    "tb/sensor/test_array_pins.py::test_array_pins[64x64 settled, four AD7606C-16]",
    "tb/sensor/test_array_pins.py::test_array_pins[3x16c]",
    "tb/sensor/test_array_forces.py::test_array_forces[large]",
    "tb/sensor/test_array_forces.py::test_array_forces[three]",
    "tb/slip/test_peak_to_peak.py::test_peak_to_peak[2-16-1-0]",
    "tb/slip/test_peak_to_peak.py::test_peak_to_peak[3-8-4-0]",
    "tb/slip/test_peak_to_peak.py::test_peak_to_peak[5-2-2-0]",
    "tb/slip/test_slip.py::test_slip[6-16-1]",
    "tb/slip/test_slip_path.py::test_slip_path[parameters1]",
    "tb/slip/test_slip_path.py::test_slip_path[parameters3]",
    "tb/slip/test_slip_path.py::test_slip_path[parameters4]",
    "tb/slip/test_slip_path.py::test_slip_path[parameters6]",
    "tb/slip/test_slip_path.py::test_slip_path[parameters7]",
    "tb/slip/test_slip_path.py::test_slip_path[parameters9]",
    "tb/slip/test_slip_serial.py::test_slip_serial[parameters0]",
    "tb/slip/test_slip_serial.py::test_slip_serial[parameters1]",
    "tb/slip/test_slip_serial.py::test_slip_serial[parameters5]",
    "tb/slip/test_slip_serial.py::test_slip_serial[parameters2]",
    "tb/slip/test_shear_speed.py::test_shear_speed[13-1-1]",
    "tb/slip/test_shear_speeds.py::test_shear_speeds[{'Channels': 8}]",
]


def left_alone(items):
    """Files of ``items`` none of whose builds `make test` runs, but for those that need a package of their
    own."""
    builds = {}
    for item in items:
        if shared_builds.calls_run(item.function) and "importorskip" not in item.function.__code__.co_names:
            left = item.get_closest_marker("long") or item.get_closest_marker("big")
            builds.setdefault(item.nodeid.split("::")[0], []).append(not left)
    return sorted(name for name, runs in builds.items() if not any(runs))


@pytest.fixture
def undrawn(monkeypatch):
    """Pictures are not rendered: for tests of numbers. Another test renders them."""
    drawing.off(monkeypatch)


def pytest_configure(config):
    # Icarus cannot run every build; benches.py does not run every test.
    judges = os.environ.get("MEISSNER_SIM", "verilator") == "verilator"
    judges = judges and "MEISSNER_RUNS" not in os.environ
    config.pluginmanager.register(applicable.Watch(config, Path(__file__).parent, judges))


def pytest_collection_finish(session):
    shared_builds.of_session[:] = session.items


def pytest_collection_modifyitems(items):
    left, files = set(BIG), {item.nodeid.split("::")[0] for item in items}
    for item in items:
        if item.nodeid in BIG:
            item.add_marker(pytest.mark.big)
            left.discard(item.nodeid)
    whole = len(items) > 1000  # a smaller run may hold only part of a file
    if gone := sorted(name for name in left if whole and name.split("::")[0] in files):
        raise pytest.UsageError(f"tb/conftest.py names {gone[0]}, which is not there")
    if whole and (alone := left_alone(items)):
        raise pytest.UsageError(f"of the builds of {alone[0]} `make test` runs none")
