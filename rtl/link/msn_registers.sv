// SPDX-License-Identifier: Apache-2.0
//
// The registers of the core. bus_valid_i for one clock asks; bus_done_o answers two clocks later, once; an
// access is an error, and changes nothing, at an address without a register in this build, at one that is no
// multiple of four, and for a write where all is read-only, now (WhileOff) or always. bus_strobe_i: the bytes that a
// write changes; one that changes no byte of a field has no effect on it.
// A setting that takes effect at a frame's start has two copies: a read sees what was written, the core what was
// committed between two frames, commit_i, all settings at once. While core.hold is 1 nothing is committed.
// The fields are those of msn_registers_pkg's table, which is made from rtl/registers.rdl.
// Resets: the reset value of every setting, in the page's order, the first lowest. Without a bus: constants.
// Some settings are wider than the build has bits for. What was written is kept byte by byte; what a read and
// the core get is held at the ends of DetailBits, TimerBits, LoadBits or OffsetBits: the lowest bits say all.
// Model: model/meissner/twins/link/registers.py

module msn_registers #(
  parameter bit          Adc        = 1'b1,
  parameter bit          Slip       = 1'b1,
  parameter bit          Scan       = 1'b1,
  parameter bit          Health     = 1'b1,
  parameter bit          Tare       = 1'b1,
  parameter bit          Calibrate  = 1'b1,
  parameter bit          Cop        = 1'b1,
  parameter bit          Cop4       = 1'b1,
  parameter bit          CopSlip    = 1'b1,
  parameter bit          Link       = 1'b1,
  parameter bit          Grip       = 1'b1,
  parameter bit          ShearSpeed = 1'b1,
  parameter bit          Forest     = 1'b1,
  parameter bit          Display    = 1'b1,
  parameter int unsigned DetailBits = 20,
  parameter int unsigned TimerBits  = 16,
  parameter int unsigned LoadBits   = 32,
  parameter int unsigned OffsetBits = 17,
  parameter logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset
) (
  input  logic        clk_i,
  input  logic        rst_i,

  input  logic        bus_valid_i,
  input  logic        bus_write_i,
  input  logic [11:0] bus_address_i,
  input  logic [31:0] bus_wdata_i,
  input  logic [3:0]  bus_strobe_i,
  output logic        bus_done_o,
  output logic        bus_error_o,
  output logic [31:0] bus_rdata_o,

  input  logic        commit_i,   // between two frames: what waits for a frame's start takes effect
  output logic        pending_o,  // something waits for it
  output msn_registers_pkg::cfg_t    cfg_o,
  input  msn_registers_pkg::status_t status_i
);

  if (DetailBits < 1 || DetailBits > 20) begin : gen_check_detail_bits
    $fatal(1, "msn_registers: DetailBits = %0d must lie in 1 .. 20", DetailBits);
  end
  if (TimerBits < 1 || TimerBits > 16) begin : gen_check_timer_bits
    $fatal(1, "msn_registers: TimerBits = %0d must lie in 1 .. 16", TimerBits);
  end
  if (LoadBits < 1 || LoadBits > 32) begin : gen_check_load_bits
    $fatal(1, "msn_registers: LoadBits = %0d must lie in 1 .. 32", LoadBits);
  end
  if (OffsetBits < 1 || OffsetBits > 17) begin : gen_check_offset_bits
    $fatal(1, "msn_registers: OffsetBits = %0d must lie in 1 .. 17", OffsetBits);
  end

  localparam int unsigned Rows = msn_registers_pkg::Rows;
  // The groups of this build by group_e, and without core, which is always there.
  localparam logic [msn_registers_pkg::Groups-1:0] Has = {
    Display, Forest, ShearSpeed, Grip, Link, CopSlip, Cop4, Cop, Calibrate, Tare, Health, Scan, Slip, Adc,
    1'b1
  };
  localparam logic [msn_registers_pkg::Groups-2:0] Features = Has[msn_registers_pkg::Groups-1:1];

  logic        write;
  logic [9:0]  word;
  logic [31:0] mask;
  assign write = bus_valid_i && bus_write_i && bus_address_i[1:0] == 2'd0;
  assign word  = bus_address_i[11:2];
  assign mask  = {{8{bus_strobe_i[3]}}, {8{bus_strobe_i[2]}}, {8{bus_strobe_i[1]}}, {8{bus_strobe_i[0]}}};

  logic [msn_registers_pkg::CfgBits-1:0]    cfg;
  logic [msn_registers_pkg::StatusBits-1:0] status;
  assign cfg_o  = cfg;
  assign status = status_i;

  // `value`, with its sign in all bits above it, as near as a number of `bits` bits comes to it.
  function automatic logic [31:0] fit(logic [31:0] value, logic is_signed, int unsigned bits);
    logic [31:0] beyond;
    beyond = is_signed ? 32'(signed'(value) >>> (bits - 1)) : 32'({1'b0, value} >> bits);
    if (beyond == '0 || (is_signed && beyond == '1)) fit = value;
    else if (is_signed) fit = {32{value[31]}} ^ ((32'd1 << (bits - 1)) - 32'd1);
    else fit = (32'd1 << bits) - 32'd1;
  endfunction

  // Each field by its row of the table.
  logic [Rows-1:0]                         here, here_q;   // the access is to its register; a clock later
  logic [Rows-1:0]                         able, delays;   // can be written; a write waits for a frame
  logic [msn_registers_pkg::ResetBits-1:0] written;        // settings as the host wrote them, as in Resets
  logic                                    commit;
  // verilator coverage_off
  logic [32*Rows-1:0] told;  // each field in its bits of a word: all others are 0
  // verilator coverage_on
  assign commit = commit_i && !cfg_o.core.hold;
  for (genvar n = 0; n < Rows; n++) begin : gen_row
    localparam msn_registers_pkg::row_t Row =
        msn_registers_pkg::Table[msn_registers_pkg::RowBits*(Rows-1-n)+:msn_registers_pkg::RowBits];
    localparam int unsigned Low   = 32'(Row.low);
    localparam int unsigned Width = 32'(Row.width);
    localparam int unsigned Place = 32'(Row.place);
    localparam int unsigned Lock  = 32'(msn_registers_pkg::Switches[12*Row.group+:12]);
    localparam int unsigned Bits  = Row.held == msn_registers_pkg::Detail ? DetailBits :
                                    Row.held == msn_registers_pkg::Timer  ? TimerBits :
                                    Row.held == msn_registers_pkg::Load   ? LoadBits :
                                    Row.held == msn_registers_pkg::Offset ? OffsetBits : Width;
    localparam bit On    = Has[Row.group];
    localparam bit Waits = On && Row.kind == msn_registers_pkg::Setting &&
                           Row.applies == msn_registers_pkg::AtFrame;
    assign here[n]   = On && word == Row.word;
    if (Row.kind == msn_registers_pkg::Command) begin : gen_able
      assign able[n] = 1'b1;
    end else if (Row.applies == msn_registers_pkg::WhileOff) begin : gen_while_off
      assign able[n] = Row.kind == msn_registers_pkg::Setting && !cfg[Lock];
    end else begin : gen_rest
      assign able[n] = Row.kind == msn_registers_pkg::Setting && Row.applies != msn_registers_pkg::AtReset;
    end
    assign delays[n] = Waits && write && here[n] && mask[Low+:Width] != '0;

    if (Row.kind == msn_registers_pkg::Setting) begin : gen_setting
      localparam logic [Width-1:0] Reset = Resets[Row.value+:Width];
      logic [Width-1:0] bits, fits;
      assign bits = written[Row.value+:Width];
      if (Bits == Width) begin : gen_whole
        assign fits = bits;
      end else begin : gen_held
        assign fits = Width'(fit(Row.is_signed ? 32'(signed'(bits)) : 32'(bits), Row.is_signed, Bits));
      end
      if (On) begin : gen_on
        always_ff @(posedge clk_i) begin
          if (write && here[n] && able[n]) begin
            written[Row.value+:Width] <= (bits & ~mask[Low+:Width]) |
                                         (bus_wdata_i[Low+:Width] & mask[Low+:Width]);
          end
          if (rst_i) written[Row.value+:Width] <= Reset;
        end
      end else begin : gen_off
        assign written[Row.value+:Width] = Reset;
      end
      if (Waits) begin : gen_committed
        always_ff @(posedge clk_i) begin
          if (commit) cfg[Place+:Width] <= fits;
          if (rst_i) begin
            cfg[Place+:Width] <=
                Width'(fit(Row.is_signed ? 32'(signed'(Reset)) : 32'(Reset), Row.is_signed, Bits));
          end
        end
      end else begin : gen_at_once
        assign cfg[Place+:Width] = fits;
      end
      assign told[32*n+:32] = On ? 32'(fits) << Low : '0;
    end else if (Row.kind == msn_registers_pkg::Command) begin : gen_command
      always_ff @(posedge clk_i) cfg[Place] <= !rst_i && write && here[n] && mask[Low] && bus_wdata_i[Low];
      assign told[32*n+:32] = '0;
    end else if (Row.kind == msn_registers_pkg::Strobe) begin : gen_strobe
      always_ff @(posedge clk_i) cfg[Place] <= !rst_i && write && here[n] && mask[Low];
      assign told[32*n+:32] = '0;
    end else if (Row.kind == msn_registers_pkg::Status) begin : gen_status
      assign told[32*n+:32] = On ? 32'(status[Place+:Width]) << Low : '0;
    end else begin : gen_constant
      assign told[32*n+:32] = Row.kind == msn_registers_pkg::Features ? 32'(Features) :
                              Row.kind == msn_registers_pkg::Widths   ? 32'(Bits) << Low : Row.value << Low;
    end
  end

  // One flag for all: they are committed together.
  logic pending;
  assign pending_o = pending && !cfg_o.core.hold;
  always_ff @(posedge clk_i) begin
    if (commit) pending <= 1'b0;
    if (delays != '0) pending <= 1'b1;
    if (rst_i) pending <= 1'b0;
  end

  // Decoding takes one clock, the word another.
  logic        asked, wrote, odd, hit, writable;
  logic [31:0] read_word;
  assign hit      = here_q != '0;
  assign writable = (here_q & able) != '0;
  always_comb begin
    read_word = '0;
    if (asked && !wrote && !odd) begin
      for (int unsigned n = 0; n < Rows; n++) read_word |= {32{here_q[n]}} & told[32*n+:32];
    end
  end

  always_ff @(posedge clk_i) begin
    here_q      <= here;
    asked       <= bus_valid_i;
    wrote       <= bus_write_i;
    odd         <= bus_address_i[1:0] != 2'd0;
    bus_done_o  <= asked;
    bus_error_o <= !hit || odd || (wrote && !writable);
    bus_rdata_o <= read_word;
    if (rst_i) begin
      asked      <= 1'b0;
      bus_done_o <= 1'b0;
    end
  end

endmodule
