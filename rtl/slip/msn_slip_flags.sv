// SPDX-License-Identifier: Apache-2.0
//
// Flags over all channels, for pins and LEDs: any channel slips, slips grossly, is touched.
//
// A flag rises on the clock after a channel's decision, and falls after a complete frame without such a decision: one
// from the first channel to `last`. The decisions of a frame that was cut short count for no later frame.
// Error: none.
// Model: model/meissner/twins/slip/slip_path.py

module msn_slip_flags (
  input  logic                 clk_i,
  input  logic                 rst_i,

  input  logic                 in_valid_i,  // a new decision, for one clock
  input  msn_pkg::slip_state_e in_state_i,
  input  logic                 in_first_i,
  input  logic                 in_last_i,

  output logic                 slip_o,      // incipient or gross
  output logic                 gross_o,
  output logic                 touched_o    // not None, not Release
);

  logic [2:0] now, any, any_q, flags;
  logic       slips, gross, held;
  assign gross = in_state_i == msn_pkg::Gross;
  assign slips = in_state_i == msn_pkg::Incipient || gross;
  assign held  = in_state_i == msn_pkg::Contact;
  assign now   = {slips || held, gross, slips};
  assign any   = in_first_i ? now : any_q | now;  // of the frame so far

  assign {touched_o, gross_o, slip_o} = flags;

  always_ff @(posedge clk_i) begin
    if (in_valid_i) begin
      flags <= in_last_i ? any : flags | now;
      any_q <= in_last_i ? '0 : any;
    end
    if (rst_i) begin
      flags <= '0;
      any_q <= '0;
    end
  end

endmodule
