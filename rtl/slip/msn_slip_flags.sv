// SPDX-License-Identifier: Apache-2.0
//
// Flags over all channels, for pins and LEDs: any channel slips, slips grossly, is touched.
//
// A flag rises on the clock after a channel's decision, and falls after a complete frame without such a decision.
// Error: none.
// Model: model/meissner/twins/slip/slip_path.py

module msn_slip_flags (
  input  logic                 clk_i,
  input  logic                 rst_i,

  input  logic                 in_valid_i,  // a new decision, for one clock
  input  msn_pkg::slip_state_e in_state_i,
  input  logic                 in_last_i,

  output logic                 slip_o,      // incipient or gross
  output logic                 gross_o,
  output logic                 touched_o    // not None, not Release
);

  logic [2:0] now, any, flags;
  logic       slips, gross, held;
  assign gross = in_state_i == msn_pkg::Gross;
  assign slips = in_state_i == msn_pkg::Incipient || gross;
  assign held  = in_state_i == msn_pkg::Contact;
  assign now   = {slips || held, gross, slips};

  assign {touched_o, gross_o, slip_o} = flags;

  always_ff @(posedge clk_i) begin
    if (in_valid_i) begin
      flags <= in_last_i ? any | now : flags | now;
      any   <= in_last_i ? '0 : any | now;
    end
    if (rst_i) begin
      flags <= '0;
      any   <= '0;
    end
  end

endmodule
