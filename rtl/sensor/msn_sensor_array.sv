// SPDX-License-Identifier: Apache-2.0
//
// A scanned array, from its lines and pins or a stream to single forces, centres of pressure and health reports.
//
//   pins or stream ─ array ─┬─ width_converter (Tap) ─ samples      registers ─ preset ─ array's calibration
//                           ├─ centres of pressure
//                           └─ health_report ─ reports
//
// The next frame is let through when the results of the previous one have left and busy_i is low.
// Model: model/meissner/twins/sensor/sensor_array.py

module msn_sensor_array #(
  parameter  int unsigned Adc              = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned Converters       = 1,
  parameter  int unsigned AdcLanes         = 1,
  parameter  int unsigned AdcChannels      = 8,
  parameter  int unsigned ClkKhz           = 25_000,
  parameter  int unsigned SclkKhz          = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  int unsigned Rows             = 1,
  parameter  int unsigned Columns          = 1,
  parameter  bit          Demod            = 1'b0,
  parameter  bit          Health           = 1'b0,
  parameter  bit          Tare             = 1'b0,
  parameter  bit          RowColumn        = 1'b0,
  parameter  bit          Tap              = 1'b1,              // samples are wanted
  parameter  int unsigned GainShift        = RowColumn ? 24 : 12,
  parameter  int unsigned TareLog2         = 4,
  parameter  int unsigned FractionBits     = 14,
  parameter  int unsigned BitsPerClock     = 2,
  parameter  int unsigned Form             = msn_pkg::DemodIq,
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned SamplePeriod     = 160,
  parameter  int unsigned Periods          = 4,
  parameter  int unsigned Skip             = 4,
  parameter  int unsigned Shift            = 3,
  localparam int unsigned SampleBits       = 17,
  localparam int unsigned Lanes            = Demod ? 1 : Converters,
  localparam int unsigned RowBeats         = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned Beats            = Rows * RowBeats,
  localparam int unsigned IdBits           = msn_pkg::index_width(Beats),
  localparam int unsigned TaxelBits        = msn_pkg::index_width(Rows * Columns),
  localparam int unsigned Inputs           = Demod ? 1 : AdcChannels,
  localparam int unsigned GroupBits        = msn_pkg::index_width((Columns + Converters * Inputs - 1)
                                                                  / (Converters * Inputs))
) (
  input  logic                           clk_i,
  input  logic                           rst_i,
  input  logic [47:0]                    now_i,

  input  msn_registers_pkg::cfg_t        cfg_i,
  output msn_registers_pkg::status_t     status_o,
  input  logic                           pending_i,
  output logic                           commit_o,
  input  logic                           busy_i,

  output logic [Rows-1:0]                row_o,
  output logic [GroupBits-1:0]           group_o,
  output logic [Converters-1:0]          adc_cs_n_o,
  output logic [Converters-1:0]          adc_sclk_o,
  output logic [Converters-1:0]          adc_mosi_o,
  input  logic [Converters*AdcLanes-1:0] adc_miso_i,
  output logic [Converters-1:0]          adc_convst_o,
  input  logic [Converters-1:0]          adc_busy_i,
  output logic [Converters-1:0]          adc_reset_o,
  output logic                           convert_o,

  input  logic                           in_valid_i,
  output logic                           in_ready_o,
  input  logic [Lanes*SampleBits-1:0]    in_data_i,
  input  logic [IdBits-1:0]              in_id_i,
  input  logic                           in_last_i,

  output logic                           sample_valid_o,
  input  logic                           sample_ready_i,
  output logic signed [SampleBits-1:0]   sample_data_o,
  output logic [TaxelBits-1:0]           sample_id_o,
  output logic                           sample_last_o,
  output logic                           sample_mask_o,
  output logic                           cop_valid_o,
  output msn_pkg::cop_t                  cop_o,
  output logic                           health_valid_o,
  input  logic                           health_ready_i,
  output msn_pkg::health_t               health_o,
  output logic [47:0]                    time_o
);

  localparam int unsigned OffsetBits = (Tare ? SampleBits + 1 : SampleBits) - 32'(RowColumn);
  localparam int unsigned SumBits    = 16 + $clog2(Rows * Columns);
  localparam int unsigned CountBits  = msn_pkg::index_width(Rows * Columns + 1);
  localparam int unsigned CopBits    = FractionBits + 2;

  // Ignore writes to words that do not exist: they would change an existing word with the same low address bits.
  localparam int unsigned Words = RowColumn ? RowBeats : Beats;
  logic word_there, row_there, zero_there;
  assign word_there = {1'b0, cfg_i.calibrate.word} < 21'(Words);
  assign row_there  = {1'b0, cfg_i.calibrate.word} < 21'(Rows);
  assign zero_there = {1'b0, cfg_i.tare.word} < 21'(Beats);

  // A gain from reset on; once it is in use, `started` can begin the first tare (cfg_i.tare.at_start).
  logic [Lanes-1:0]      lanes, write;
  logic                  written, write_row, swap, started;
  logic [IdBits-1:0]     word;
  logic [OffsetBits-1:0] offset, given_offset;
  logic [15:0]           gain;
  assign lanes   = cfg_i.calibrate.write_lanes[Lanes-1:0];
  assign written = cfg_i.calibrate.write_written;
  assign given_offset = OffsetBits'(signed'(cfg_i.calibrate.offset));
  msn_calibration_preset #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .OffsetBits(OffsetBits), .RowColumn(RowColumn)
  ) u_preset (
    .clk_i, .rst_i,
    .cfg_gain_i(cfg_i.calibrate.preset),
    .in_write_i((written && !cfg_i.calibrate.write_row && word_there) ? lanes : '0),
    .in_write_row_i(written && cfg_i.calibrate.write_row && row_there),
    .in_word_i(cfg_i.calibrate.word[IdBits-1:0]), .in_offset_i(given_offset),
    .in_gain_i(cfg_i.calibrate.gain), .in_swap_i(cfg_i.calibrate.swap),
    .out_write_o(write), .out_write_row_o(write_row), .out_word_o(word), .out_offset_o(offset),
    .out_gain_o(gain), .out_swap_o(swap),
    .done_o(started)
  );

  msn_registers_pkg::scan_status_t      scan;
  msn_registers_pkg::health_status_t    health;
  msn_registers_pkg::tare_status_t      tare;
  msn_registers_pkg::calibrate_status_t calibrate;
  msn_registers_pkg::cop_status_t       cop;
  always_comb begin
    status_o           = '0;
    status_o.scan      = scan;
    status_o.health    = health;
    status_o.tare      = tare;
    status_o.calibrate = calibrate;
    status_o.cop       = cop;
  end

  logic                      tap_valid, tap_ready, tap_row_last, tap_last;
  logic [Lanes*16-1:0]       tap_data;
  logic [Lanes-1:0]          tap_mask;
  logic signed [CopBits-1:0] x, y;
  logic [SumBits-1:0]        load;
  logic                      event_valid, event_ready;
  logic [IdBits-1:0]         event_id;
  logic [Lanes-1:0]          event_dead, event_railed, event_blinking;
  logic [CountBits-1:0]      dead, railed, blinking;
  msn_array #(
    .Rows(Rows), .Columns(Columns), .Demod(Demod), .Health(Health), .Tare(Tare), .Part(Adc),
    .Converters(Converters), .Channels(AdcChannels), .AdcLanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz),
    .Form(Form), .SamplesPerPeriod(SamplesPerPeriod), .SamplePeriod(SamplePeriod), .Periods(Periods),
    .Skip(Skip), .Shift(Shift), .RowColumn(RowColumn), .GainShift(GainShift), .TareLog2(TareLog2),
    .FractionBits(FractionBits), .BitsPerClock(BitsPerClock), .Tap(Tap)
  ) u_array (
    .clk_i, .rst_i,
    .now_i,
    .cfg_enable_i(cfg_i.scan.enable), .cfg_settle_i(cfg_i.scan.settle), .cfg_period_i(cfg_i.scan.period),
    .cfg_interleave_i(cfg_i.scan.interleave), .cfg_band_i(cfg_i.health.band), .cfg_jump_i(cfg_i.health.jump),
    .cfg_low_i(cfg_i.health.low), .cfg_high_i(cfg_i.health.high),
    .cfg_over_range_enable_i(cfg_i.health.use_user),
    .cfg_edges_i(cfg_i.health.use_edges), .cfg_still_i(cfg_i.health.still), .cfg_rail_i(cfg_i.health.rail),
    .cfg_blink_i(cfg_i.health.blink), .cfg_clear_i(cfg_i.health.clear), .cfg_report_i(cfg_i.health.report),
    .cfg_contact_i(cfg_i.tare.contact), .cfg_step_i(cfg_i.tare.step),
    .cfg_tare_i(cfg_i.tare.average || (started && cfg_i.tare.at_start)),
    .cfg_force_i(cfg_i.tare.force_ || started), .cfg_load_i(cfg_i.tare.load),
    .cfg_zero_write_i((cfg_i.tare.write_written && zero_there) ? cfg_i.tare.write[Lanes-1:0] : '0),
    .cfg_zero_word_i(cfg_i.tare.word[IdBits-1:0]), .cfg_zero_i(cfg_i.tare.zero),
    .cfg_loading_o(tare.state_loading), .cfg_write_i(write), .cfg_write_row_i(write_row), .cfg_word_i(word),
    .cfg_offset_i(offset), .cfg_gain_i(gain), .cfg_swap_i(swap), .cfg_swapping_o(calibrate.swapping),
    .cfg_min_load_i(SumBits'(cfg_i.cop.min_load)),
    .row_o, .group_o,
    .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
    .convert_o,
    .in_valid_i, .in_ready_o, .in_data_i, .in_id_i, .in_last_i,
    .cfg_pending_i(pending_i), .commit_o, .busy_i, .time_o,
    .tap_valid_o(tap_valid), .tap_ready_i(tap_ready), .tap_data_o(tap_data), .tap_mask_o(tap_mask),
    .tap_row_last_o(tap_row_last), .tap_last_o(tap_last),
    .out_valid_o(cop_valid_o), .out_ready_i(1'b1), .out_x_o(x), .out_y_o(y), .out_load_o(load),
    .out_pressed_o(cop_o.pressed),
    .event_valid_o(event_valid), .event_ready_i(event_ready), .event_id_o(event_id),
    .event_dead_o(event_dead), .event_railed_o(event_railed), .event_blinking_o(event_blinking),
    .dead_o(dead), .railed_o(railed), .blinking_o(blinking), .taring_o(tare.state_taring),
    .pressed_o(tare.state_pressed), .tared_o(tare.tared), .refused_o(tare.refused), .dropped_o(scan.dropped),
    .overrun_o(scan.overrun), .held_o(scan.held), .lost_o(scan.lost), .swallowed_o(tare.swallowed),
    .damaged_o(cop.damaged)
  );
  assign cop_o.x         = 24'(x);
  assign cop_o.y         = 24'(y);
  assign cop_o.load      = 40'(load);
  assign health.dead     = 21'(dead);
  assign health.railed   = 21'(railed);
  assign health.blinking = 21'(blinking);

  msn_health_report #(.IdBits(IdBits), .Lanes(Lanes)) u_health_report (
    .clk_i, .rst_i,
    .in_valid_i(event_valid), .in_ready_o(event_ready), .in_id_i(event_id), .in_dead_i(event_dead),
    .in_railed_i(event_railed), .in_blinking_i(event_blinking),
    .out_valid_o(health_valid_o), .out_ready_i(health_ready_i), .out_id_o(health_o.id),
    .out_faults_o(health_o.faults)
  );

  logic [Lanes*17-1:0] tap;  // lane by lane, the mask above the force
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    assign tap[17*k+:17] = {tap_mask[k], tap_data[16*k+:16]};
  end
  logic [15:0] force_of_taxel;
  msn_width_converter #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes), .DataBits(17)) u_width_converter (
    .clk_i, .rst_i,
    .in_valid_i(tap_valid), .in_ready_o(tap_ready), .in_data_i(tap), .in_row_last_i(tap_row_last),
    .in_last_i(tap_last),
    .out_valid_o(sample_valid_o), .out_ready_i(sample_ready_i), .out_data_o({sample_mask_o, force_of_taxel}),
    .out_id_o(sample_id_o), .out_last_o(sample_last_o)
  );
  assign sample_data_o = {1'b0, force_of_taxel};

  logic unused_cfg;
  assign unused_cfg = ^cfg_i;

endmodule
