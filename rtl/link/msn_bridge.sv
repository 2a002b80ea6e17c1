// SPDX-License-Identifier: Apache-2.0
//
// Registers over a serial line: commands in, the register bus (msn_registers) out, answers to msn_packet.
//
//   command   operation (0 read, 1 write), tag, address (2 bytes), data (4), CRC-32: plain COBS between zeros
//   answer    tag, status (0 done, 1 error from the bus, 2 no answer from the bus), address, data read
//
// The answer repeats the command's tag. A frame that is not such a command, has a wrong checksum, pauses for
// TimeoutClocks, has a line error, or arrives before the last command is answered changes nothing, is not answered
// and is counted. The access follows the closing zero by 2 clocks, the answer follows bus_done_i by 1.
// Error: none.
// Model: model/meissner/twins/link/bridge.py

module msn_bridge #(
  parameter int unsigned TimeoutClocks = 120_000
) (
  input  logic        clk_i,
  input  logic        rst_i,

  input  logic        in_valid_i,      // a byte from the line
  input  logic [7:0]  in_data_i,
  input  logic        in_error_i,      // a byte with an error

  output logic        bus_valid_o,
  output logic        bus_write_o,
  output logic [11:0] bus_address_o,
  output logic [31:0] bus_wdata_o,
  output logic [3:0]  bus_strobe_o,
  input  logic        bus_done_i,
  input  logic        bus_error_i,
  input  logic [31:0] bus_rdata_i,

  output logic        answer_valid_o,
  input  logic        answer_ready_i,
  output logic [63:0] answer_data_o,

  output logic [31:0] rejected_o       // frames, since reset
);

  if (TimeoutClocks < 16) begin : gen_check_timeout
    $fatal(1, "msn_bridge: TimeoutClocks = %0d must be at least 16", TimeoutClocks);
  end

  localparam int unsigned CommandBytes = 12;
  localparam int unsigned WaitBits     = $clog2(TimeoutClocks + 1);

  // The line's byte again, a clock later: it is known late, and the command's registers depend on all of it.
  logic       heard, damaged;
  logic [7:0] heard_data;
  always_ff @(posedge clk_i) begin
    heard_data       <= in_data_i;
    {heard, damaged} <= {in_valid_i, in_error_i};
    if (rst_i) {heard, damaged} <= '0;
  end

  // COBS frames: a code is the number of bytes up to the next code, which stands for a zero of the command.
  logic [7:0]          run;      // bytes before the next code
  logic [3:0]          count;    // bytes of the command so far, 15: too many
  logic                open;     // a frame has begun
  logic                spoilt;   // this frame is to be rejected
  logic [WaitBits-1:0] waited;
  logic [63:0]         command;  // its first eight bytes
  logic [31:0]         crc;
  logic                delimiter, is_code, push, late, good;
  logic [7:0]          pushed;
  assign delimiter = heard && heard_data == '0;
  assign is_code   = run == '0;
  assign push      = heard && !delimiter && (!is_code || open);
  assign pushed    = is_code ? '0 : heard_data;
  assign late      = open && waited == WaitBits'(TimeoutClocks);
  assign good      = open && !spoilt && is_code && count == 4'(CommandBytes) && crc == 32'hDEBB_20E3
                     && command[7:1] == '0 && command[31:28] == '0;

  always_ff @(posedge clk_i) begin
    waited <= (!open || heard) ? '0 : waited + 1'b1;
    if (heard) begin
      open <= !delimiter;
      run  <= delimiter ? '0 : is_code ? heard_data - 1'b1 : run - 1'b1;
      if (delimiter) count <= '0;
      else if (push && !(&count)) count <= count + 1'b1;
      if (push && !count[3]) command <= {pushed, command[63:8]};
    end
    spoilt <= (spoilt && !delimiter) || (damaged && open);
    if (late) begin
      open  <= 1'b0;
      run   <= '0;
      count <= '0;
    end
    if (rst_i) begin
      open   <= 1'b0;
      spoilt <= 1'b0;
      run    <= '0;
      count  <= '0;
    end
  end

  msn_crc32 #(.Bits(8)) u_crc (
    .clk_i, .clear_i(delimiter || !open), .step_i(push), .in_data_i(pushed), .out_crc_o(crc)
  );

  // Access and answer.
  logic       busy, asked, start, timed_out, reject;
  logic [7:0] timeout;
  assign busy     = asked || answer_valid_o;
  assign start    = delimiter && good && !busy;
  assign timed_out = asked && (&timeout) && !bus_done_i;

  always_ff @(posedge clk_i) begin
    bus_valid_o <= start;
    timeout    <= asked ? timeout + 1'b1 : '0;
    if (start) begin
      asked         <= 1'b1;
      bus_write_o   <= command[0];
      bus_address_o <= command[27:16];
      bus_wdata_o    <= command[63:32];
    end
    if (start) answer_data_o[31:0] <= {4'd0, command[27:16], 8'd0, command[15:8]};
    if (asked && (bus_done_i || timed_out)) begin
      asked                <= 1'b0;
      answer_valid_o       <= 1'b1;
      answer_data_o[9:8]   <= {timed_out, bus_done_i && bus_error_i};
      answer_data_o[63:32] <= bus_rdata_i;
    end
    if (answer_valid_o && answer_ready_i) answer_valid_o <= 1'b0;
    reject     <= (delimiter && open && !start) || late;
    rejected_o <= rejected_o + 32'(reject);
    if (rst_i) begin
      asked          <= 1'b0;
      bus_valid_o    <= 1'b0;
      answer_valid_o <= 1'b0;
      reject         <= 1'b0;
      rejected_o     <= '0;
    end
  end
  assign bus_strobe_o = '1;

endmodule
