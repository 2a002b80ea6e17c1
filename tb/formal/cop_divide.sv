// SPDX-License-Identifier: Apache-2.0
//
// Mx is divided by (n-1) S, My by (m-1) S; |x|, |y| <= 1.0; both are 0 and `pressed` is low unless the load is above 0
// and at least the minimum; the load is that of the same frame; the dividers are always in step, with operands in
// their range. Assumed of the moments, as msn_cop_accumulate's: |Mx| <= (n-1) S, |My| <= (m-1) S.

module formal_cop_divide #(
  parameter  int unsigned Rows         = 64,
  parameter  int unsigned Columns      = 64,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  localparam int unsigned SumBits      = 16 + $clog2(Rows * Columns),
  localparam int unsigned MxBits       = SumBits + msn_pkg::index_width(Columns),
  localparam int unsigned MyBits       = SumBits + msn_pkg::index_width(Rows),
  localparam int unsigned CopBits      = FractionBits + 2
) (
  input logic                      clk_i,
  input logic                      rst_i,
  input logic        [SumBits-1:0] cfg_min_load_i,
  input logic                      in_valid_i,
  input logic        [SumBits-1:0] in_sum_i,
  input logic signed [MxBits-1:0]  in_mx_i,
  input logic signed [MyBits-1:0]  in_my_i,
  input logic                      out_ready_i
);

  logic                      in_ready_o, out_valid_o, out_pressed_o;
  logic signed [CopBits-1:0] out_x_o, out_y_o;
  logic        [SumBits-1:0] out_load_o;
  msn_cop_divide #(
    .Rows(Rows), .Columns(Columns), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock)
  ) dut (.*);

  localparam int unsigned Wide = MxBits + MyBits;
  logic                started = 1'b0;
  logic                busy, pressed, stalled, load;
  logic [SumBits-1:0]  sum;
  logic [Wide-1:0]     size_x, size_y, most_x, most_y;
  logic [CopBits-1:0]  x, y;
  assign load   = in_valid_i && in_ready_o;
  assign size_x = Wide'(in_mx_i < 0 ? -(MxBits+1)'(in_mx_i) : (MxBits+1)'(in_mx_i));
  assign size_y = Wide'(in_my_i < 0 ? -(MyBits+1)'(in_my_i) : (MyBits+1)'(in_my_i));
  // (n-1) S as 2^k S - (2^k - n + 1) S: solvers are slow where the block subtracts and a product adds.
  assign most_x = (Wide'(in_sum_i) << $clog2(Columns)) - Wide'(in_sum_i) * Wide'((1 << $clog2(Columns)) - Columns + 1);
  assign most_y = (Wide'(in_sum_i) << $clog2(Rows)) - Wide'(in_sum_i) * Wide'((1 << $clog2(Rows)) - Rows + 1);
  assign x      = out_x_o < 0 ? -out_x_o : out_x_o;
  assign y      = out_y_o < 0 ? -out_y_o : out_y_o;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    if (out_valid_o && out_ready_i) busy <= 1'b0;
    if (load) begin
      busy    <= 1'b1;
      sum     <= in_sum_i;
      pressed <= in_sum_i != '0 && in_sum_i >= cfg_min_load_i;
    end
    if (rst_i) busy <= 1'b0;
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (in_valid_i) assume (size_x <= most_x && size_y <= most_y);
    if (started) begin
      if (out_valid_o) begin
        assert (busy && out_load_o == sum && out_pressed_o == pressed);
        assert (x <= CopBits'(1) << FractionBits);
        assert (y <= CopBits'(1) << FractionBits);
        if (!pressed) assert (out_x_o == '0 && out_y_o == '0);
      end
      if (stalled) assert (out_valid_o);
      if (!rst_i && !busy) assert (in_ready_o);
      if (!rst_i) assert (dut.ready_x == in_ready_o && dut.ready_y == in_ready_o);
      assert (dut.unused_valid == out_valid_o);
      // The operands; that the quotient is right is proof `divide`.
      assert (out_x_o == (out_pressed_o ? dut.quotient_x : '0) && out_y_o == (out_pressed_o ? dut.quotient_y : '0));
      if (load) begin
        assert (Wide'(dut.den_x) == (in_sum_i == '0 ? Wide'(1) : Columns > 1 ? most_x : Wide'(in_sum_i)));
        assert (Wide'(dut.den_y) == (in_sum_i == '0 ? Wide'(1) : Rows > 1 ? most_y : Wide'(in_sum_i)));
        assert (dut.num_x == ((Columns > 1) ? in_mx_i : MxBits'(signed'(0))) && dut.num_y == ((Rows > 1) ? in_my_i : MyBits'(signed'(0))));
        assert (dut.den_x != '0 && dut.den_y != '0);
        assert ((dut.num_x < 0 ? -dut.num_x : dut.num_x) <= {1'b0, dut.den_x});
        assert ((dut.num_y < 0 ? -dut.num_y : dut.num_y) <= {1'b0, dut.den_y});
      end
    end
  end

  // Invariant: that of proof `divide` for each divider, as far as the bound needs it.
  localparam int unsigned Steps    = (FractionBits + 3) / 2;
  localparam int unsigned LongBits = CopBits + 2;
  logic [7:0]          turns;
  logic [LongBits-1:0] digits_x, digits_y, limit;
  assign limit = LongBits'(1) << ((turns == '0) ? 0 : 2 * 32'(turns) - 1);
  always_ff @(posedge clk_i) begin
    if (dut.u_x.turn) begin
      turns    <= turns + 8'd1;
      digits_x <= (digits_x << 2) + LongBits'(dut.u_x.digit);
      digits_y <= (digits_y << 2) + LongBits'(dut.u_y.digit);
    end
    if (load) begin
      turns    <= '0;
      digits_x <= '0;
      digits_y <= '0;
    end
  end
  always_comb begin
    if (started) begin
      assert (dut.u_y.turn == dut.u_x.turn && dut.u_y.count == dut.u_x.count);
      assert (dut.u_x.turn == (busy && turns != 8'(Steps)) && out_valid_o == (busy && turns == 8'(Steps)));
      if (busy) begin
        assert (turns <= 8'(Steps) && (!dut.u_x.turn || 8'(dut.u_x.count) == turns));
        assert (dut.u_x.out_side_o == {sum, pressed});
        assert (dut.u_x.den != '0 && dut.u_y.den != '0);
        assert ({dut.u_x.low, dut.u_x.step} ==
                (dut.u_x.negative ? ~digits_x : digits_x));
        assert ({dut.u_y.low, dut.u_y.step} ==
                (dut.u_y.negative ? ~digits_y : digits_y));
        if (turns == '0) begin
          assert (digits_x == '0 && digits_y == '0);
          assert (dut.u_x.rest <= {1'b0, dut.u_x.den, 1'b0});
          assert (dut.u_y.rest <= {1'b0, dut.u_y.den, 1'b0});
          assert (dut.u_x.gen_two.triple == '1 && dut.u_y.gen_two.triple == '1);
          assert (!dut.u_x.rest[0] && !dut.u_y.rest[0]);
          assert (dut.u_x.high == '0 && dut.u_y.high == '0);
        end else begin
          assert ((dut.u_x.rest >> 2) < dut.u_x.den && dut.u_x.rest[1:0] == '0);
          assert ((dut.u_y.rest >> 2) < dut.u_y.den && dut.u_y.rest[1:0] == '0);
          assert (dut.u_x.high == dut.u_x.low + 1'b1);
          assert (dut.u_y.high == dut.u_y.low + 1'b1);
          assert (dut.u_x.gen_two.triple == {2'b0, dut.u_x.den} + {1'b0, dut.u_x.den, 1'b0});
          assert (dut.u_y.gen_two.triple == {2'b0, dut.u_y.den} + {1'b0, dut.u_y.den, 1'b0});
          assert (digits_x < limit || (digits_x == limit && dut.u_x.rest == '0));
          assert (digits_y < limit || (digits_y == limit && dut.u_y.rest == '0));
        end
      end
    end
  end

  always_comb begin
    if (started && !rst_i && out_valid_o) begin
      cover (x == CopBits'(1) << FractionBits && out_y_o != '0);
      cover (!out_pressed_o && out_load_o != '0);
      cover (stalled && out_y_o < 0);
    end
  end

endmodule
