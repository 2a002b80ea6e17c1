// SPDX-License-Identifier: Apache-2.0
//
// The core: registers, a sensor, slip, a hand's reflex and the link. Instances and wires only, in data-path order; a
// block that a parameter turns off is not built.
//
//   registers ─ settings, status of all
//   sensor_array, sensor_channels or sensor_cop4 ─┬─ samples ─ slip_chain ─┬─ link ─ line or bytes
//                                                 └─ results, reports ─────┘
//   shear_speeds (ShearSpeed) ─ actuate (Grip) ─ words, pulses for a hand, from channels' samples, decisions, speeds
//   classify (Forest) ─ class of a window of frames, or of features in registers: packets, and the hand's slip
//   display (Display) ─ pins of a tactile display, from images, centres of pressure, slips or a host
//
// Adc = AdcNone: complete frames of samples enter on the stream, for an array Converters lanes wide. Uart = 0: packets
// leave as bytes and the register bus is a port, for msn_axis. SlipOnly: the smaller link that sends only slip events.
// Model: model/meissner/twins/core.py

module msn_core #(
  // The sensor and its converters.
  parameter  int unsigned Adc              = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned Converters       = 1,
  parameter  int unsigned AdcLanes         = 1,
  parameter  int unsigned AdcChannels      = 8,                 // of each converter of an array
  parameter  int unsigned ClkKhz           = 25_000,
  parameter  int unsigned SclkKhz          = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  int unsigned AdcPeriod        = 0,                 // clocks, built in: msn_acquire
  parameter  bit          ReadDuring       = 1'b0,              // read frames while the next is converted
  parameter  bit          Array            = 1'b0,
  parameter  int unsigned Rows             = 1,
  parameter  int unsigned Columns          = 1,
  parameter  int unsigned Channels         = 1,                 // where there is no array
  // The processing stages and their parameters.
  parameter  bit          Demod            = 1'b0,
  parameter  bit          Health           = 1'b0,
  parameter  bit          Tare             = 1'b0,
  parameter  bit          RowColumn        = 1'b0,
  parameter  bit          Slip             = 1'b1,
  parameter  bit          Serial           = 1'b0,
  parameter  bit          Image            = 1'b0,
  parameter  bit          Cop4             = 1'b0,
  parameter  bit          Correct          = 1'b0,
  parameter  bit          CopSlip          = 1'b0,
  parameter  bit          Grip             = 1'b0,              // the channels are fingers of a hand
  parameter  bit          ShearSpeed       = 1'b0,              // the channels are sheared rubber
  parameter  bit          Forest           = 1'b0,              // this and the following: msn_classify
  parameter  bit          ForestFrames     = 1'b1,
  parameter  bit          ForestSdram      = 1'b0,
  parameter  bit          Display          = 1'b0,              // a tactile display
  parameter  bit          Statistics       = 1'b1,
  parameter  bit          Registers        = 1'b1,
  parameter  bit          Uart             = 1'b1,
  parameter  bit          SlipOnly         = 1'b0,
  parameter  int unsigned Level            = 1,
  parameter  int unsigned Window           = 64,
  parameter  int unsigned Hop              = 64,
  parameter  int unsigned TimerBits        = 16,
  parameter  int unsigned SampleBits       = 17,                // narrower for single channels only
  parameter  int unsigned GainShift        = RowColumn ? 24 : 12,  // 4096, with RowColumn 4096^2: gain 1.0
  parameter  int unsigned TareLog2         = 4,
  parameter  int unsigned FractionBits     = 14,
  parameter  int unsigned BitsPerClock     = 2,
  parameter  int unsigned Form             = msn_pkg::DemodIq,
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned SamplePeriod     = 160,
  parameter  int unsigned Periods          = 4,
  parameter  int unsigned Skip             = 4,
  parameter  int unsigned Shift            = 3,
  parameter  int unsigned Lag              = 16,
  parameter  int unsigned PinRows          = 5,
  parameter  int unsigned PinColumns       = 20,
  parameter  int unsigned PinChains        = 1,
  parameter  int unsigned AmplitudeBits    = 4,                 // of a pin's level
  parameter  int unsigned BaudHz           = 3_000_000,
  parameter  int unsigned SlipDepth        = 64,
  parameter  int unsigned StatisticBits    = 22,
  parameter  int unsigned Chunk            = 64,
  parameter  int unsigned ForestFeatures   = 54,
  parameter  int unsigned ForestBits       = 18,
  parameter  int unsigned ForestClasses    = 2,
  parameter  int unsigned ForestTrees      = 64,
  parameter  int unsigned ForestNodes      = 1024,
  parameter  int unsigned ForestLeaves     = 256,
  parameter  int unsigned ForestEngines    = 1,
  parameter  int unsigned ForestBanks      = 2,
  parameter  int unsigned ForestLanes      = 4,
  parameter  logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset,
  localparam int unsigned Lanes            = (!Array || Demod) ? 1 : Converters,
  localparam int unsigned RowBeats         = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned Taxels           = Array ? Rows * Columns : Channels,
  localparam int unsigned InIdBits         = msn_pkg::index_width(Array ? Rows * RowBeats : Channels),
  localparam int unsigned Inputs           = Demod ? 1 : AdcChannels,
  localparam int unsigned GroupBits        = msn_pkg::index_width((Columns + Converters * Inputs - 1)
                                                                  / (Converters * Inputs))
) (
  input  logic                            clk_i,
  input  logic                            rst_i,

  output logic [Rows-1:0]                 row_o,
  output logic [GroupBits-1:0]            group_o,
  output logic [Converters-1:0]           adc_cs_n_o,
  output logic [Converters-1:0]           adc_sclk_o,
  output logic [Converters-1:0]           adc_mosi_o,
  input  logic [Converters*AdcLanes-1:0]  adc_miso_i,
  output logic [Converters-1:0]           adc_convst_o,
  input  logic [Converters-1:0]           adc_busy_i,
  output logic [Converters-1:0]           adc_reset_o,
  input  logic                            actuator_moving_i,

  input  logic                            in_valid_i,        // Adc = AdcNone
  output logic                            in_ready_o,
  input  logic [Lanes*SampleBits-1:0]     in_data_i,
  input  logic [InIdBits-1:0]             in_id_i,
  input  logic                            in_last_i,

  output logic                            slip_o,            // of any channel
  output logic                            gross_o,
  output logic                            touched_o,
  output logic                            pressed_o,         // the last centre of pressure
  output logic                            grip_valid_o,      // msn_actuate's
  output logic signed [16:0]              grip_word_o,
  output logic                            pwm_o,

  output msn_pkg::sdram_t                 sdram_o,           // ForestSdram
  input  logic [15:0]                     sdram_dq_i,
  output logic [PinChains-1:0]            hv_data_o,         // msn_pin_shift's
  output logic                            hv_clk_o,
  output logic                            hv_le_o,
  output logic                            hv_bl_o,
  output logic                            hv_pol_o,
  output logic                            hv_dir_o,

  output msn_pkg::verdict_t               verdict_o,         // each decision of the slip chain, for a bench
  output msn_pkg::decision_t              decision_o,        // or an engine, with verdict_o.valid

  input  logic                            rx_i,
  output logic                            tx_o,

  input  logic                            bus_valid_i,       // Uart = 0
  input  logic                            bus_write_i,
  input  logic [11:0]                     bus_address_i,
  input  logic [31:0]                     bus_wdata_i,
  input  logic [3:0]                      bus_strobe_i,
  output logic                            bus_done_o,
  output logic                            bus_error_o,
  output logic [31:0]                     bus_rdata_o,
  output logic                            out_valid_o,
  input  logic                            out_ready_i,
  output logic [7:0]                      out_data_o,
  output logic                            out_last_o
);

  if (Array ? Cop4 || Serial : Health || Tare || Demod || RowColumn || Image) begin : gen_check_array
    $fatal(1, "msn_core: Array = 1 must go without Cop4, Serial; stages of an array must go with Array = 1");
  end
  if (Cop4 ? Slip || Channels != 4 : CopSlip || Correct) begin : gen_check_cop4
    $fatal(1, "msn_core: Cop4 must go with Channels = 4, not Slip; CopSlip and Correct with Cop4 = 1");
  end
  if (Array ? !msn_pkg::are_lanes(Converters) : Converters != 1) begin : gen_check_lanes
    $fatal(1, "msn_core: Converters = %0d must lie in 1 .. 8, and be 1 without Array", Converters);
  end
  if (SampleBits > 17 || (SampleBits != 17 && (Array || Cop4))) begin : gen_check_sample_bits
    $fatal(1, "msn_core: SampleBits = %0d must be at most 17, and 17 with Array or Cop4", SampleBits);
  end
  if (SlipOnly && (!Slip || Array || Registers || !Uart)) begin : gen_check_slip_only
    $fatal(1, "msn_core: SlipOnly = 1 must go with Slip and Uart, without Array and Registers");
  end
  localparam bit          Pins       = Adc != msn_pkg::AdcNone;
  localparam int unsigned DetailBits = SampleBits + Level;
  localparam int unsigned IdBits     = msn_pkg::index_width(Taxels);
  // Bits of offsets and loads in this build, where its registers are wider: docs/registers.md, core.widths.
  localparam int unsigned OffsetBits = RowColumn ? 16 : 17;
  localparam int unsigned LoadBits   = (Taxels > 65536) ? 32 : 16 + $clog2(Taxels);

  logic [47:0] now;
  msn_registers_pkg::cfg_t    cfg;
  msn_registers_pkg::status_t status, sensor_status;
  logic        bus_valid, bus_write, bus_done, bus_error, commit, pending;
  logic [11:0] bus_address;
  logic [31:0] bus_wdata, bus_rdata;
  logic [3:0]  bus_strobe;
  msn_registers #(
    .Adc(!Array && Pins), .Slip(Slip), .Scan(Array && Pins), .Health(Health), .Tare(Tare), .Calibrate(Array),
    .Cop(Array), .Cop4(Cop4), .CopSlip(CopSlip), .Link(1'b1), .Grip(Grip),
    .ShearSpeed(ShearSpeed), .Forest(Forest), .Display(Display), .Resets(Resets),
    .DetailBits(DetailBits), .TimerBits(TimerBits), .LoadBits(LoadBits), .OffsetBits(OffsetBits)
  ) u_registers (
    .clk_i, .rst_i,
    .bus_valid_i(bus_valid), .bus_write_i(bus_write), .bus_address_i(bus_address), .bus_wdata_i(bus_wdata),
    .bus_strobe_i(bus_strobe), .bus_done_o(bus_done), .bus_error_o(bus_error), .bus_rdata_o(bus_rdata),
    .commit_i(commit), .pending_o(pending), .cfg_o(cfg), .status_i(status)
  );

  msn_registers_pkg::slip_status_t        of_slip;
  msn_registers_pkg::link_status_t        of_link;
  msn_registers_pkg::grip_status_t        of_grip;
  msn_registers_pkg::shear_speed_status_t of_shear;
  msn_registers_pkg::forest_status_t      of_forest;
  msn_registers_pkg::display_status_t     of_display;
  always_comb begin
    status              = sensor_status;
    {status.core.size_rows, status.core.size_columns} = Array ? {16'(Rows), 16'(Columns)} :
                                                                {16'd1, 16'(Channels)};
    status.core.clk_khz = 32'(ClkKhz);
    status.core.beats   = Array ? 21'(Rows * RowBeats) : 21'd0;
    status.core.lanes   = Array ? 4'(Lanes) : 4'd0;
    {status.slip, status.link, status.grip, status.shear_speed} = {of_slip, of_link, of_grip, of_shear};
    {status.forest, status.display} = {of_forest, of_display};
  end

  // The sensor: single samples for the slip path, and centres of pressure.
  logic                         sample_valid, sample_ready, sample_last, sample_mask, convert;
  logic signed [SampleBits-1:0] sample, stream;
  logic        [IdBits-1:0]     sample_id;
  logic        [47:0]           frame_time;
  logic                         given_valid, given_ready, class_valid, class_ready, decided, forest_slips;
  logic                         slip_valid, slip_ready, slip_busy, forest_busy, cop_valid, health_valid;
  logic                         health_ready, frame_busy;
  logic                         cop_slip_valid, cop_slip_ready, decision_valid, decision_ready;
  msn_pkg::cop_t                cop;
  msn_pkg::health_t             health;
  msn_pkg::decision_t           cop_slip;
  msn_pkg::shear_t              shear;
  msn_pkg::class_t              class_change;
  assign frame_busy = slip_busy || forest_busy;
  assign stream = signed'(in_data_i[SampleBits-1:0]);  // of one lane

  if (Array) begin : gen_array
    msn_sensor_array #(
      .Adc(Adc), .Converters(Converters), .AdcLanes(AdcLanes), .AdcChannels(AdcChannels), .ClkKhz(ClkKhz),
      .SclkKhz(SclkKhz), .ReadDuring(ReadDuring), .Rows(Rows), .Columns(Columns), .Demod(Demod),
      .Health(Health), .Tare(Tare), .RowColumn(RowColumn),
      .Tap(Slip || Image || Display || (Forest && ForestFrames)), .GainShift(GainShift), .TareLog2(TareLog2),
      .FractionBits(FractionBits), .BitsPerClock(BitsPerClock), .Form(Form),
      .SamplesPerPeriod(SamplesPerPeriod), .SamplePeriod(SamplePeriod), .Periods(Periods), .Skip(Skip),
      .Shift(Shift)
    ) u_sensor (
      .clk_i, .rst_i, .now_i(now), .cfg_i(cfg), .status_o(sensor_status), .pending_i(pending),
      .commit_o(commit), .busy_i(frame_busy), .row_o, .group_o,
      .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
      .convert_o(convert), .in_valid_i, .in_ready_o, .in_data_i, .in_id_i, .in_last_i,
      .sample_valid_o(sample_valid), .sample_ready_i(sample_ready), .sample_data_o(sample),
      .sample_id_o(sample_id), .sample_last_o(sample_last), .sample_mask_o(sample_mask),
      .cop_valid_o(cop_valid), .cop_o(cop), .health_valid_o(health_valid), .health_ready_i(health_ready),
      .health_o(health), .time_o(frame_time)
    );
    assign {cop_slip_valid, cop_slip} = '0;
  end else if (Cop4) begin : gen_cop4
    msn_sensor_cop4 #(
      .Adc(Adc), .AdcLanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .AdcPeriod(AdcPeriod),
      .ReadDuring(ReadDuring), .Correct(Correct), .BitsPerClock(BitsPerClock), .CopSlip(CopSlip), .Lag(Lag)
    ) u_sensor (
      .clk_i, .rst_i, .now_i(now), .cfg_i(cfg), .status_o(sensor_status), .pending_i(pending),
      .commit_o(commit), .adc_cs_n_o(adc_cs_n_o[0]), .adc_sclk_o(adc_sclk_o[0]), .adc_mosi_o(adc_mosi_o[0]),
      .adc_miso_i(adc_miso_i[AdcLanes-1:0]), .adc_convst_o(adc_convst_o[0]), .adc_busy_i(adc_busy_i[0]),
      .adc_reset_o(adc_reset_o[0]), .convert_o(convert),
      .in_valid_i, .in_ready_o, .in_data_i(stream), .in_id_i, .in_last_i,
      .cop_valid_o(cop_valid), .cop_o(cop), .time_o(frame_time),
      .decision_valid_o(cop_slip_valid), .decision_ready_i(cop_slip_ready), .decision_o(cop_slip)
    );
    assign {row_o, group_o, sample_valid, sample, sample_id, sample_last, sample_mask} = '0;
    assign {health_valid, health} = '0;
  end else begin : gen_channels
    logic unused_first;
    msn_sensor_channels #(
      .Adc(Adc), .AdcLanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .AdcPeriod(AdcPeriod),
      .Channels(Channels), .SampleBits(SampleBits), .Gate(!SlipOnly),
      .ReadDuring(ReadDuring)
    ) u_sensor (
      .clk_i, .rst_i, .now_i(now), .cfg_i(cfg), .status_o(sensor_status), .pending_i(pending),
      .commit_o(commit), .busy_i(frame_busy), .adc_cs_n_o(adc_cs_n_o[0]), .adc_sclk_o(adc_sclk_o[0]),
      .adc_mosi_o(adc_mosi_o[0]), .adc_miso_i(adc_miso_i[AdcLanes-1:0]), .adc_convst_o(adc_convst_o[0]),
      .adc_busy_i(adc_busy_i[0]), .adc_reset_o(adc_reset_o[0]), .convert_o(convert),
      .in_valid_i, .in_ready_o, .in_data_i(stream), .in_id_i, .in_last_i,
      .sample_valid_o(sample_valid), .sample_ready_i(sample_ready), .sample_data_o(sample),
      .sample_id_o(sample_id), .sample_first_o(unused_first), .sample_last_o(sample_last),
      .time_o(frame_time)
    );
    assign {row_o, group_o, sample_mask, cop_valid, cop, health_valid, health, cop_slip_valid, cop_slip} = '0;
  end

  // The forest's part, beside the other blocks.
  msn_classify #(
    .Forest(Forest), .Suits(Registers && !SlipOnly && !(ForestFrames && Cop4)), .Frames(ForestFrames),
    .Channels(Taxels), .SampleBits(SampleBits), .Features(ForestFeatures), .FeatureBits(ForestBits),
    .Classes(ForestClasses), .Trees(ForestTrees), .Nodes(ForestNodes), .Leaves(ForestLeaves),
    .Engines(ForestEngines), .Banks(ForestBanks), .Lanes(ForestLanes), .Sdram(ForestSdram), .ClkKhz(ClkKhz)
  ) u_classify (
    .clk_i, .rst_i, .now_i(now), .time_i(frame_time), .cfg_i(cfg.forest), .status_o(of_forest),
    .in_valid_i(sample_valid), .in_ready_o(sample_ready), .in_data_i(sample), .in_id_i(sample_id),
    .in_last_i(sample_last), .out_valid_o(given_valid), .out_ready_i(given_ready), .busy_o(forest_busy),
    .change_valid_o(class_valid), .change_ready_i(class_ready), .change_o(class_change),
    .decided_o(decided), .slips_o(forest_slips), .sdram_o, .sdram_dq_i
  );

  localparam bit Fingers = Slip && Registers && !Array && !Serial;  // Grip and ShearSpeed need these
  msn_shear_speeds #(
    .ShearSpeed(ShearSpeed), .Suits(Fingers), .Channels(Taxels), .SampleBits(SampleBits)
  ) u_shear_speeds (
    .clk_i, .rst_i, .cfg_i(cfg.shear_speed), .status_o(of_shear), .actuator_moving_i,
    .grip_valid_i(grip_valid_o), .grip_i(of_grip), .in_valid_i(given_valid), .in_ready_o(given_ready),
    .in_data_i(sample), .in_id_i(sample_id), .in_last_i(sample_last),
    .out_valid_o(slip_valid), .out_ready_i(slip_ready), .report_o(shear)
  );

  // Slip of every channel or taxel, or of the centre of pressure.
  msn_slip_chain #(
    .Slip(Slip), .Array(Array), .Lanes(Lanes), .Channels(Taxels), .SampleBits(SampleBits), .Level(Level),
    .Window(Window), .Hop(Hop), .TimerBits(TimerBits), .Mask(Health), .Serial(Serial)
  ) u_slip (
    .clk_i, .rst_i,
    .cfg_i(cfg.slip), .status_o(of_slip), .actuator_moving_i,
    .in_valid_i(slip_valid), .in_ready_o(slip_ready), .in_data_i(sample), .in_id_i(sample_id),
    .in_last_i(sample_last), .in_mask_i(sample_mask),
    .cop_valid_i(cop_slip_valid), .cop_ready_o(cop_slip_ready), .cop_i(cop_slip),
    .out_valid_o(decision_valid), .out_ready_i(decision_ready), .out_o(decision_o), .verdict_o,
    .busy_o(slip_busy), .slip_o, .gross_o, .touched_o
  );

  // An array is one finger, by its forest.
  localparam int unsigned Hand     = Array ? 1 : Taxels;
  localparam int unsigned HandBits = msn_pkg::index_width(Hand);
  msn_registers_pkg::adc_status_t read_by;
  always_comb begin
    read_by = sensor_status.adc;
    if (Array) read_by.timeout = sensor_status.scan.lost;
  end
  msn_actuate #(
    .Grip(Grip), .Suits(Array ? Forest && Registers : Fingers), .Single(Array), .Fingers(Hand),
    .SampleBits(SampleBits)
  ) u_actuate (
    .clk_i, .rst_i, .cfg_i(cfg.grip), .status_o(of_grip),
    .sample_valid_i(!Array && sample_valid && sample_ready), .sample_data_i(sample),
    .sample_id_i(sample_id[HandBits-1:0]), .adc_i(read_by), .verdict_i(verdict_o), .shear_i(shear),
    .decided_i(decided), .slips_i(forest_slips), .grip_valid_o, .grip_word_o, .pwm_o
  );

  localparam bit Imaged = Array || (!Cop4 && Channels > 1);
  msn_display #(
    .Display(Display), .Suits(Imaged || Cop4), .Image(Imaged), .Directed(CopSlip), .Rows(Array ? Rows : 1),
    .Columns(Array ? Columns : (Channels > 1) ? Channels : 2), .PinRows(PinRows), .PinColumns(PinColumns),
    .Chains(PinChains), .AmplitudeBits(AmplitudeBits), .ClkKhz(ClkKhz)
  ) u_display (
    .clk_i, .rst_i, .cfg_i(cfg.display), .status_o(of_display),
    .image_valid_i(sample_valid && sample_ready), .image_data_i(sample < 0 ? 16'd0 : 16'(sample)),
    .image_last_i(sample_last), .cop_valid_i(cop_valid), .cop_i(cop), .slip_i(slip_o || gross_o),
    .raised_i(cop_slip_valid && cop_slip.raised), .octant_i(cop_slip.p2p[2:0]), .sensor_i(sensor_status),
    .hv_data_o, .hv_clk_o, .hv_le_o, .hv_bl_o, .hv_pol_o, .hv_dir_o
  );

  // Packets to the host, commands from it.
  msn_link #(
    .ClkKhz(ClkKhz), .BaudHz(BaudHz), .SlipOnly(SlipOnly), .Uart(Uart), .Registers(Registers), .Array(Array),
    .DetailBits(DetailBits), .SlipChannels(Slip ? Taxels : 1), .FirstState(CopSlip ? 65535 : 0),
    .SlipDepth((Slip || CopSlip) ? SlipDepth : 0), .Cop(Array || Cop4), .Classes(Forest), .Health(Health),
    .Statistics(Statistics), .StatisticBits(StatisticBits), .Taxels(Image ? Taxels : 0), .Chunk(Chunk)
  ) u_link (
    .clk_i, .rst_i, .now_o(now), .cfg_i(cfg.link), .status_i(status), .status_o(of_link), .convert_i(convert),
    .time_i(frame_time), .class_valid_i(class_valid), .class_ready_o(class_ready), .class_i(class_change),
    .cop_valid_i(cop_valid), .cop_i(cop), .pressed_o, .decision_valid_i(decision_valid),
    .decision_ready_o(decision_ready), .decision_i(decision_o),
    .health_valid_i(health_valid), .health_ready_o(health_ready), .health_i(health),
    .image_valid_i(Image && cfg.link.images && sample_valid && sample_ready), .image_data_i(16'(sample)),
    .image_last_i(sample_last),
    .bus_valid_o(bus_valid), .bus_write_o(bus_write), .bus_address_o(bus_address), .bus_wdata_o(bus_wdata),
    .bus_strobe_o(bus_strobe), .bus_done_i(bus_done), .bus_error_i(bus_error), .bus_rdata_i(bus_rdata),
    .rx_i, .tx_o,
    .host_valid_i(bus_valid_i), .host_write_i(bus_write_i), .host_address_i(bus_address_i),
    .host_wdata_i(bus_wdata_i), .host_strobe_i(bus_strobe_i), .host_done_o(bus_done_o),
    .host_error_o(bus_error_o), .host_rdata_o(bus_rdata_o),
    .out_valid_o, .out_ready_i, .out_data_o, .out_last_o
  );

  // Signals that some builds do not use.
  logic unused;
  assign unused = ^{cfg, sample, stream, in_data_i, frame_busy, health_ready, cop_slip_ready};

endmodule
