// SPDX-License-Identifier: Apache-2.0
//
// Delay line: each word leaves Depth steps after it entered; between steps the contents hold.
//
//   out_data_o at a step = in_data_i Depth steps earlier
//
// It stores the state of interleaved channels: channels take turns, so a delay of one step per channel returns
// each channel's own state, without addresses and forwarding. Deeper than 4: a ring in block RAM that never reads and
// writes the same slot in one clock. The output is undefined for the first Depth steps.
// Model: model/meissner/twins/common/delay.py

module msn_delay #(
  parameter int unsigned Depth = 8,
  parameter int unsigned Width = 16
) (
  input  logic             clk_i,
  input  logic             rst_i,

  input  logic             step_i,
  input  logic [Width-1:0] in_data_i,
  output logic [Width-1:0] out_data_o
);

  if (Depth < 1) begin : gen_check_depth
    $fatal(1, "msn_delay: Depth = %0d must be at least 1", Depth);
  end
  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_delay: Width = %0d must be at least 1", Width);
  end

  if (Depth <= 4) begin : gen_registers
    logic [Depth*Width-1:0] line;  // the newest word lowest
    assign out_data_o = line[(Depth-1)*Width+:Width];
    if (Depth == 1) begin : gen_one
      always_ff @(posedge clk_i) if (step_i) line <= in_data_i;
    end else begin : gen_more
      always_ff @(posedge clk_i) if (step_i) line <= {line[(Depth-1)*Width-1:0], in_data_i};
    end
    logic unused_rst;
    assign unused_rst = rst_i;

  end else begin : gen_ring
    // The memory is far from the logic, so there is a register at its input and one after its output. With the two
    // of the memory these are four of the Depth steps.
    localparam int unsigned Slots    = Depth - 3;
    localparam int unsigned SlotBits = msn_pkg::index_width(Slots);

    logic [SlotBits-1:0] slot, slot_next;
    assign slot_next = (slot == SlotBits'(Slots - 1)) ? '0 : slot + 1'b1;

    logic [Width-1:0] newest, oldest;
    msn_ram #(.Words(Slots), .Width(Width)) u_ring (
      .clk_i,
      .write_i(step_i), .write_address_i(slot), .write_data_i(newest),
      .read_i(step_i), .read_address_i(slot_next), .out_data_o(oldest)
    );

    always_ff @(posedge clk_i) begin
      if (step_i) begin
        newest     <= in_data_i;
        out_data_o <= oldest;
        slot       <= slot_next;
      end
      if (rst_i) slot <= '0;
    end

    // Reading a slot in the clock in which it is written is undefined.
    msn_check u_read_is_not_written (.clk_i, .rst_i, .wrong_i(!rst_i && step_i && slot == slot_next));
  end

endmodule
