# Bitstream for the Arty A7-35T with Vivado. Not tested: Vivado was not available.
#
#   python tools/make/synth.py --macros arty_a7 fingertip     build/synth/arty_a7-fingertip/msn_build.svh
#   vivado -mode batch -source tools/make/arty_a7.tcl -tclargs fingertip
#
# Run it in the repository's root, with slip1, fingertip, or the name of a TOML file without its suffix. For the
# -100T change the part.

set config [expr {$argc > 0 ? [lindex $argv 0] : "fingertip"}]
set folder build/synth/arty_a7-$config
if {![file exists $folder/msn_build.svh]} {
  puts stderr "run first: python tools/make/synth.py --macros arty_a7 $config"
  exit 2
}

set list [open rtl/rtl.f]
set sources [split [string trim [read $list]] "\n"]
close $list
lappend sources rtl/boards/msn_board_reset.sv rtl/boards/msn_board.sv rtl/boards/arty_a7_clock.sv $folder/arty_a7_top.sv

read_verilog -sv $sources
read_xdc $folder/arty_a7_top.xdc
synth_design -top arty_a7_top -part xc7a35ticsg324-1L -include_dirs $folder
opt_design
place_design
phys_opt_design
route_design
report_utilization -file $folder/utilization.rpt
report_timing_summary -file $folder/timing.rpt
if {[get_property SLACK [get_timing_paths]] < 0} {
  puts stderr "$config on the Arty A7 does not meet its clock; see $folder/timing.rpt"
  exit 1
}
write_bitstream -force $folder/arty_a7_top.bit
