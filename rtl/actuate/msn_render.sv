// SPDX-License-Identifier: Apache-2.0
//
// A tactile image, a centre of pressure and a slip as a frame of pin levels: docs/pin_display.md.
//
//   average  of a pin: sum of (overlap of taxel and pin) x / Taxels, the image's area divided evenly among the pins
//   level    0 if the average is below floor, else 1 + floor((average - floor) / step), at most 2^AmplitudeBits - 1
//   marker   the pin under the newest centre of pressure as the frame begins has the highest level
//   slip     in place of these stripes, every fourth pin, that move a pin in the slip's direction every `cue` frames
//
// Image: a frame for each complete image, the newest first. Without: for each centre of pressure. A taxel a clock: all
// overlaps of a pin, then 6 clocks and one a level for each pin. Widths hold every sum, so nothing is rounded.
// Error: none.
// Model: model/meissner/twins/actuate/render.py

module msn_render #(
  parameter bit          Image         = 1'b1,
  parameter int unsigned Rows          = 16,
  parameter int unsigned Columns       = 16,
  parameter int unsigned PinRows       = 5,
  parameter int unsigned PinColumns    = 20,
  parameter int unsigned AmplitudeBits = 4
) (
  input  logic               clk_i,
  input  logic               rst_i,

  input  logic [15:0]        cfg_floor_i,
  input  logic [15:0]        cfg_step_i,      // 0: all above the floor has the highest level
  input  logic               cfg_marker_i,
  input  logic [7:0]         cfg_cue_i,       // frames; 0: a slip is not shown

  input  logic               in_valid_i,      // taxels of an image, row by row, never stalled
  input  logic [15:0]        in_data_i,
  input  logic               in_last_i,

  input  logic               cop_valid_i,
  input  logic signed [15:0] cop_x_i,         // Q2.14; +y is towards row 0
  input  logic signed [15:0] cop_y_i,
  input  logic               cop_pressed_i,
  input  logic               slip_i,
  input  logic [2:0]         octant_i,        // of msn_cop_slip: counter-clockwise from +x

  output logic               out_valid_o,
  output logic [7:0]         out_data_o,
  output logic               out_last_o,
  output logic               busy_o
);

  if (!msn_pkg::is_side(Rows) || !msn_pkg::is_side(Columns) || Rows * Columns < 2 || Rows * Columns > 65535)
  begin : gen_check_image
    $fatal(1, "msn_render: Rows = %0d and Columns = %0d must make 2 .. 65535 taxels", Rows, Columns);
  end
  if (PinRows < 1 || PinRows > 128 || PinColumns < 1 || PinColumns > 128 || PinRows * PinColumns < 2)
  begin : gen_check_pins
    $fatal(1, "msn_render: PinRows = %0d and PinColumns = %0d must lie in 1 .. 128, 2 pins or more", PinRows,
           PinColumns);
  end
  if (AmplitudeBits < 1 || AmplitudeBits > 6) begin : gen_check_amplitude_bits
    $fatal(1, "msn_render: AmplitudeBits = %0d must lie in 1 .. 6", AmplitudeBits);
  end

  localparam logic [7:0] Top = 8'((1 << AmplitudeBits) - 1);

  // Pin by pin: `ask` begins a pin, `known` ends it with its level of the image.
  localparam int unsigned PinRowBits    = msn_pkg::index_width(PinRows);
  localparam int unsigned PinColumnBits = msn_pkg::index_width(PinColumns);
  logic                     start, ask, known, due, final_column, final_pin;
  logic [PinRowBits-1:0]    pin_row;
  logic [PinColumnBits-1:0] pin_column;
  logic [7:0]               level;
  assign final_column = pin_column == PinColumnBits'(PinColumns - 1);
  assign final_pin    = final_column && pin_row == PinRowBits'(PinRows - 1);
  always_ff @(posedge clk_i) begin
    due <= cop_valid_i || (due && !start);
    ask <= start || (known && !final_pin);
    if (known) begin
      pin_column <= final_column ? '0 : pin_column + 1'b1;
      if (final_column) pin_row <= final_pin ? '0 : pin_row + 1'b1;
    end
    if (rst_i) begin
      due        <= 1'b0;
      ask        <= 1'b0;
      pin_row    <= '0;
      pin_column <= '0;
    end
  end

  // The marker's pin, and the stripes: right and up are -1, 0 or 1, mod 4 as all of it.
  localparam int unsigned AlongBits = 16 + msn_pkg::index_width(PinColumns + 1);
  localparam int unsigned DownBits  = 16 + msn_pkg::index_width(PinRows + 1);
  logic [15:0]              x, y;          // from the left and the upper end, 2^15 at the other end
  logic                     pressed, mark, marked, slips;
  logic [PinRowBits-1:0]    mark_row;
  logic [PinColumnBits-1:0] mark_column;
  logic [2:0]               octant;
  logic [1:0]               phase, right, up, across, climb, stripe;
  logic [7:0]               cue, cue_next;
  logic [AlongBits-1:0]     along;
  logic [DownBits-1:0]      down;
  msn_constant_multiplier #(.Constant(PinColumns), .InBits(16)) u_along (.in_data_i(x), .out_data_o(along));
  msn_constant_multiplier #(.Constant(PinRows), .InBits(16)) u_down (.in_data_i(y), .out_data_o(down));
  assign right    = octant[1:0] == 2'd2 ? 2'd0 : (octant >= 3'd3 && octant <= 3'd5) ? 2'd3 : 2'd1;
  assign up       = octant[1:0] == 2'd0 ? 2'd0 : octant[2] ? 2'd3 : 2'd1;
  assign across   = right == '0 ? '0 : right[1] ? -(2'(pin_column)) : 2'(pin_column);  // right * column
  assign climb    = up == '0 ? '0 : up[1] ? -(2'(pin_row)) : 2'(pin_row);
  assign stripe   = across - climb - phase;
  assign cue_next = cue + 1'b1;
  assign marked   = mark && mark_column == pin_column && mark_row == pin_row;
  always_ff @(posedge clk_i) begin
    if (cop_valid_i) begin
      x       <= 16'(cop_x_i) + 16'h4000;
      y       <= 16'h4000 - 16'(cop_y_i);
      pressed <= cop_pressed_i;
    end
    if (start) begin
      slips       <= slip_i && cfg_cue_i != '0;
      octant      <= octant_i;
      mark        <= cfg_marker_i && pressed;
      mark_column <= x[15] ? PinColumnBits'(PinColumns - 1) : PinColumnBits'(along >> 15);
      mark_row    <= y[15] ? PinRowBits'(PinRows - 1) : PinRowBits'(down >> 15);
    end
    if (known && final_pin) begin
      cue <= !slips || cue_next >= cfg_cue_i ? '0 : cue_next;
      if (!slips) phase <= '0;
      else if (cue_next >= cfg_cue_i) phase <= phase + 1'b1;
    end
    out_valid_o <= known;
    out_last_o  <= final_pin;
    out_data_o  <= slips ? (stripe == '0 ? Top : '0) : marked ? Top : level;
    if (rst_i) begin
      pressed     <= 1'b0;
      cue         <= '0;
      phase       <= '0;
      out_valid_o <= 1'b0;
    end
  end

  if (Image) begin : gen_image
    localparam int unsigned Taxels      = Rows * Columns;
    localparam int unsigned AddressBits = msn_pkg::index_width(Taxels);
    localparam int unsigned HighBits    = $clog2((Rows > PinRows ? Rows : PinRows) + 1);
    localparam int unsigned WideBits    = $clog2((Columns > PinColumns ? Columns : PinColumns) + 1);
    localparam int unsigned WeightBits  = $clog2((Rows < PinRows ? Rows : PinRows) + 1)
                                          + $clog2((Columns < PinColumns ? Columns : PinColumns) + 1);
    localparam int unsigned SumBits     = 18 + $clog2(Taxels);

    logic                   image_valid;
    logic [47:0]            unused_time;
    logic [31:0]            unused_dropped;
    logic [AddressBits-1:0] address, row_base;
    logic [15:0]            taxel;
    assign start = !busy_o && image_valid && !out_valid_o;
    msn_image_store #(.Taxels(Taxels)) u_store (
      .clk_i, .rst_i, .in_valid_i, .in_data_i, .in_last_i, .in_time_i('0),
      .read_valid_o(image_valid), .read_time_o(unused_time), .read_begun_i(busy_o && !(known && final_pin)),
      .read_done_i(known && final_pin), .read_address_i(address), .read_data_o(taxel),
      .dropped_o(unused_dropped)
    );

    // A taxel is PinRows high and PinColumns wide, a pin Rows high and Columns wide. What is left of the present ones,
    // and where this pin, or this row of pins, begins.
    localparam logic [HighBits-1:0] TaxelHigh = HighBits'(PinRows);
    localparam logic [HighBits-1:0] PinHigh   = HighBits'(Rows);
    localparam logic [WideBits-1:0] TaxelWide = WideBits'(PinColumns);
    localparam logic [WideBits-1:0] PinWide   = WideBits'(Columns);
    logic                   walking, end_row, end_pin;
    logic [HighBits-1:0]    taxel_high, pin_high, high, high_0, high_next;
    logic [WideBits-1:0]    taxel_wide, pin_wide, wide, wide_0, wide_next;
    logic [AddressBits-1:0] column, column_0, column_next, row_base_0, row_next;
    assign high        = taxel_high < pin_high ? taxel_high : pin_high;
    assign wide        = taxel_wide < pin_wide ? taxel_wide : pin_wide;
    assign end_row     = pin_wide == wide;
    assign end_pin     = end_row && pin_high == high;
    assign wide_next   = taxel_wide == wide ? TaxelWide : taxel_wide - wide;
    assign column_next = taxel_wide == wide ? column + 1'b1 : column;
    assign high_next   = taxel_high == high ? TaxelHigh : taxel_high - high;
    assign row_next    = taxel_high == high ? row_base + AddressBits'(Columns) : row_base;
    assign address     = row_base + column;
    always_ff @(posedge clk_i) begin
      if (walking) begin
        pin_wide   <= end_row ? PinWide : pin_wide - wide;
        taxel_wide <= end_row ? wide_0 : wide_next;
        column     <= end_row ? column_0 : column_next;
        if (end_row) begin
          pin_high   <= end_pin ? PinHigh : pin_high - high;
          taxel_high <= high_next;
          row_base   <= row_next;
        end
        if (end_pin) begin  // the next pin begins beside this one, or the next row of pins below it
          walking    <= 1'b0;
          taxel_wide <= final_column ? TaxelWide : wide_next;
          wide_0     <= final_column ? TaxelWide : wide_next;
          column     <= final_column ? '0 : column_next;
          column_0   <= final_column ? '0 : column_next;
          taxel_high <= final_column ? high_next : high_0;
          row_base   <= final_column ? row_next : row_base_0;
          if (final_column) begin
            high_0     <= high_next;
            row_base_0 <= row_next;
          end
        end
      end
      if (ask) walking <= 1'b1;
      if (start) begin
        {pin_high, pin_wide}             <= {PinHigh, PinWide};
        {taxel_high, high_0}             <= {TaxelHigh, TaxelHigh};
        {taxel_wide, wide_0}             <= {TaxelWide, TaxelWide};
        {column, column_0}               <= '0;
        {row_base, row_base_0}           <= '0;
      end
      if (rst_i) walking <= 1'b0;
    end

    // The sum of a pin, floor taken off each taxel: two clocks for the taxel, two for the product.
    logic [3:0]                     last;
    logic [WeightBits-1:0]          weight_1, weight_2;
    logic                           walked_1, walked_2, walked_3, walked_4;
    logic signed [16:0]             above;
    logic signed [16+WeightBits:0]  product;
    logic signed [SumBits-1:0]      rest, step, taken;
    logic [15+msn_pkg::index_width(Taxels+1):0] step_area;
    logic                           dividing, again;
    logic [7:0]                     found;
    assign above = signed'({1'b0, taxel}) - signed'({1'b0, cfg_floor_i});
    msn_multiply #(.AWidth(17), .BWidth(WeightBits)) u_product (
      .clk_i, .enable_i(1'b1), .a_i(above), .b_i(weight_2), .y_o(product)
    );
    msn_constant_multiplier #(.Constant(Taxels), .InBits(16)) u_step (
      .in_data_i(cfg_step_i), .out_data_o(step_area)
    );
    assign step  = signed'({1'b0, (SumBits - 1)'(step_area)});
    assign taken = found == '0 ? '0 : step;  // the first level begins at the floor
    assign again = rest >= taken && found < Top;
    assign known = dividing && !again;
    assign busy_o = ask || walking || last != '0 || dividing;  // no flag, in which an upset would stay
    assign level = found;
    always_ff @(posedge clk_i) begin
      last     <= {last[2:0], walking && end_pin};
      weight_1 <= WeightBits'(high * wide);
      weight_2 <= weight_1;
      {walked_4, walked_3, walked_2, walked_1} <= {walked_3, walked_2, walked_1, walking};
      if (ask) rest <= '0;
      else if (walked_4) rest <= rest + SumBits'(product);
      else if (dividing) rest <= rest - taken;
      dividing <= last[3] || (dividing && again);
      if (last[3]) found <= '0;
      else if (dividing && again) found <= found + 1'b1;
      if (rst_i) begin
        last     <= '0;
        dividing <= 1'b0;
        {walked_4, walked_3, walked_2, walked_1} <= '0;
      end
    end
    logic unused;
    assign unused = ^{unused_time, unused_dropped, due, product};
  end else begin : gen_none
    assign start  = due && !busy_o && !out_valid_o;
    assign busy_o = ask;
    assign known  = ask;
    assign level  = '0;
    logic unused;
    assign unused = ^{in_valid_i, in_data_i, in_last_i, cfg_floor_i, cfg_step_i};
  end

endmodule
