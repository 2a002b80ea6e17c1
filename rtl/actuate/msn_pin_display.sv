// SPDX-License-Identifier: Apache-2.0
//
// Drives the pins of a tactile display through chains of high-voltage drivers (HV507), within limits: docs/pin_display.md.
//
//   frames ── image_store ── pin_limits ── pin_shift ── drivers        pin_phase: when
//
//   pin   high in the first L + 1 of a drive period's 2^(AmplitudeBits + 1) slots for level L, 0: low
//   L     min(level, top) of the newest complete frame, from a period's beginning on; 0 where a limit says so
//
// A slot's outputs change Lead clocks after the phase reaches it, all at once. All is off in reset, without enable or
// frames, and from a fault's next clock on; the period after that, and after a change of frequency, is silent.
// Error: none.
// Model: model/meissner/twins/actuate/pin_display.py

module msn_pin_display #(
  parameter  int unsigned Pins          = 100,
  parameter  int unsigned Chains        = 1,        // of drivers, side by side
  parameter  int unsigned AmplitudeBits = 4,
  parameter  int unsigned ClkKhz        = 25_000,
  parameter  int unsigned SclkKhz       = 8_000,    // at most
  parameter  int unsigned MinHz         = 1,
  parameter  int unsigned MaxHz         = 400,
  parameter  int unsigned TickClocks    = (ClkKhz + 3) / 4,  // a quarter ms
  parameter  int unsigned Ticks         = 5715,     // of a seventh of the window of the duty: 10 s
  parameter  bit          Direction     = 1'b0,
  localparam int unsigned PinBits       = $clog2(Pins + 1)
) (
  input  logic               clk_i,
  input  logic               rst_i,

  input  logic               cfg_enable_i,
  input  logic [31:0]        cfg_increment_i,
  input  logic [11:0]        cfg_burst_period_i,
  input  logic [11:0]        cfg_burst_on_i,
  input  logic [7:0]         cfg_top_i,
  input  logic [11:0]        cfg_most_i,
  input  logic [15:0]        cfg_duty_i,
  input  logic [3:0]         cfg_watchdog_i,
  input  logic [15:0]        cfg_stop_i,

  input  logic               fault_i,

  input  logic               in_valid_i,            // levels of a frame, never stalled
  input  logic [7:0]         in_data_i,
  input  logic               in_last_i,

  output logic [Chains-1:0]  hv_data_o,
  output logic               hv_clk_o,
  output logic               hv_le_o,
  output logic               hv_bl_o,
  output logic               hv_pol_o,
  output logic               hv_dir_o,

  output logic               running_o,
  output logic               wrap_o,                // a period begins at the pins
  output logic [PinBits-1:0] pins_o,
  output logic               limited_o,             // a limit keeps a pin off
  output logic [15:0]        dropped_o              // frames damaged, or replaced before they were shown
);

  localparam int unsigned SlotBits   = AmplitudeBits + 1;
  localparam int unsigned PlaceBits  = msn_pkg::index_width(Pins);
  localparam int unsigned ChainBits  = ((Pins + Chains - 1) / Chains + 63) / 64 * 64;
  localparam int unsigned Half       = (ClkKhz + 2 * SclkKhz - 1) / (2 * SclkKhz);
  localparam int unsigned Lead       = Pins + ChainBits / 8 * 9 * 2 * Half + 48;  // of msn_pin_shift
  localparam int unsigned SlotClocks = 32'(64'(ClkKhz) * 1000 / (64'(MaxHz) << SlotBits));
  if (SlotClocks < Lead + 8) begin : gen_check_slot
    $fatal(1, "msn_pin_display: AmplitudeBits = %0d makes slots of %0d clocks but a load needs %0d",
           AmplitudeBits, SlotClocks, Lead + 8);
  end

  // Levels above the highest are held to it as they come.
  localparam logic [AmplitudeBits-1:0] Top = '1;
  logic                     frame_valid, frame_begun, frame_done;
  logic                     step;  // a frame that ends in its clock waits: the phase would not see it
  logic [AmplitudeBits-1:0] top, in_level;
  assign top      = |cfg_top_i[7:AmplitudeBits] ? Top : AmplitudeBits'(cfg_top_i);
  assign in_level = |in_data_i[7:AmplitudeBits] ? Top : AmplitudeBits'(in_data_i);
  logic [PlaceBits-1:0]     frame_place;
  logic [15:0]              frame_level;
  logic [47:0]              unused_time;
  logic [31:0]              dropped;
  assign dropped_o = dropped[15:0];
  msn_image_store #(.Taxels(Pins)) u_frames (
    .clk_i, .rst_i, .in_valid_i, .in_data_i(16'(in_level)), .in_last_i, .in_time_i('0),
    .read_valid_o(frame_valid), .read_time_o(unused_time), .read_begun_i(frame_begun || step),
    .read_done_i(frame_done), .read_address_i(frame_place), .read_data_o(frame_level), .dropped_o(dropped)
  );

  logic                off, begins, silent, burst, turn, limits_busy, limits_idle, shift_busy;
  logic [SlotBits-1:0] slot;
  logic [12:0]         length;
  msn_pin_phase #(
    .ClkKhz(ClkKhz), .MinHz(MinHz), .MaxHz(MaxHz), .SlotBits(SlotBits), .TickClocks(TickClocks), .Ticks(Ticks)
  ) u_phase (
    .clk_i, .rst_i, .cfg_enable_i, .cfg_increment_i, .cfg_burst_period_i, .cfg_burst_on_i, .cfg_stop_i,
    .fault_i, .frame_valid_i(frame_valid), .idle_i(limits_idle && !shift_busy),
    .running_o, .off_o(off), .begin_o(begins), .step_o(step), .slot_o(slot), .silent_o(silent),
    .burst_o(burst), .length_o(length), .turn_o(turn)
  );

  logic                     level_valid, level_last;
  logic [AmplitudeBits-1:0] level;
  msn_pin_limits #(.Pins(Pins), .AmplitudeBits(AmplitudeBits)) u_limits (
    .clk_i, .rst_i, .cfg_top_i(top), .cfg_most_i, .cfg_duty_i, .cfg_watchdog_i,
    .running_i(running_o), .begin_i(begins), .off_i(off), .silent_i(silent), .burst_i(burst),
    .length_i(length), .turn_i(turn),
    .frame_begun_o(frame_begun), .frame_done_o(frame_done), .frame_place_o(frame_place),
    .frame_level_i(frame_level[AmplitudeBits-1:0]),
    .out_valid_o(level_valid), .out_level_o(level), .out_last_o(level_last),
    .busy_o(limits_busy), .idle_o(limits_idle), .pins_o, .limited_o
  );

  msn_pin_shift #(
    .Pins(Pins), .Chains(Chains), .AmplitudeBits(AmplitudeBits), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz),
    .Direction(Direction)
  ) u_shift (
    .clk_i, .rst_i, .in_valid_i(level_valid), .in_level_i(level), .in_last_i(level_last),
    .running_i(running_o), .off_i(off), .begin_i(begins), .step_i(step), .slot_i(slot),
    .busy_i(limits_busy), .busy_o(shift_busy),
    .hv_data_o, .hv_clk_o, .hv_le_o, .hv_bl_o, .hv_pol_o, .hv_dir_o, .wrap_o
  );

  logic unused;
  assign unused = ^{unused_time, frame_level[15:AmplitudeBits], dropped[31:16]};

endmodule
