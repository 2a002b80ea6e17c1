// SPDX-License-Identifier: Apache-2.0
//
// Made by tools/registers.py from rtl/registers.rdl: change that, then `make registers`.
//
// The registers of the core. bus_valid_i for one clock asks; bus_done_o answers on the next, once; an access
// is an error, and changes nothing, at an address without a register in this build, at one that is no
// multiple of four, and for a write where all is read-only. bus_strobe_i: the bytes that a write changes. A
// group with commit_i keeps two copies: a read sees what was written, the core what was committed.
// Model: model/meissner/link/registers.py

// verilog_lint: waive-start line-length

module msn_registers #(
  parameter bit Adc = 1'b1,
  parameter bit Slip = 1'b1
) (
  input  logic        clk_i,
  input  logic        rst_i,

  input  logic        bus_valid_i,
  input  logic        bus_write_i,
  input  logic [11:0] bus_address_i,
  input  logic [31:0] bus_data_i,
  input  logic [3:0]  bus_strobe_i,
  output logic        bus_done_o,
  output logic        bus_error_o,
  output logic [31:0] bus_data_o,

  input  logic [31:0] core_features_i,
  input  logic [15:0] core_size_columns_i,
  input  logic [15:0] core_size_rows_i,
  input  logic [31:0] core_clk_khz_i,
  output logic [31:0] core_scratch_o,

  output logic        adc_enable_o,
  output logic [23:0] adc_period_o,
  input  logic [31:0] adc_dropped_i,
  input  logic [31:0] adc_overrun_i,
  input  logic [31:0] adc_timeout_i,
  input  logic [31:0] adc_over_range_i,

  input  logic        slip_commit_i,  // written values take effect
  output logic        slip_pending_o,  // some wait for it
  output logic [19:0] slip_threshold_o,
  output logic [19:0] slip_gross_threshold_o,
  output logic [19:0] slip_contact_level_o,
  output logic [19:0] slip_release_level_o,
  output logic        slip_contact_rises_o,
  output logic [15:0] slip_hold_o,
  output logic [15:0] slip_refractory_o,
  output logic [15:0] slip_blank_o,
  input  logic [31:0] slip_damaged_i,
  input  logic [31:0] slip_blanked_i
);

  logic        write;
  logic [9:0]  word;
  logic [31:0] mask;
  assign write = bus_valid_i && bus_write_i && bus_address_i[1:0] == 2'd0;
  assign word  = bus_address_i[11:2];
  assign mask  = {{8{bus_strobe_i[3]}}, {8{bus_strobe_i[2]}}, {8{bus_strobe_i[1]}}, {8{bus_strobe_i[0]}}};

  logic core_id_hit;
  assign core_id_hit = word == 10'h000;

  logic core_version_hit;
  assign core_version_hit = word == 10'h001;

  logic core_features_hit;
  assign core_features_hit = word == 10'h002;

  logic core_size_hit;
  assign core_size_hit = word == 10'h003;

  logic core_clk_khz_hit;
  assign core_clk_khz_hit = word == 10'h004;

  logic core_scratch_hit, core_scratch_write;
  assign core_scratch_hit = word == 10'h005;
  assign core_scratch_write = core_scratch_hit && write;
  always_ff @(posedge clk_i) begin
    if (core_scratch_write) core_scratch_o <= (core_scratch_o & ~mask[31:0]) | (bus_data_i[31:0] & mask[31:0]);
    if (rst_i) core_scratch_o <= 32'h0;
  end

  logic adc_enable_hit, adc_enable_write;
  assign adc_enable_hit = Adc && word == 10'h040;
  assign adc_enable_write = adc_enable_hit && write;
  always_ff @(posedge clk_i) begin
    if (adc_enable_write) adc_enable_o <= (adc_enable_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) adc_enable_o <= 1'h0;
  end

  logic adc_period_hit, adc_period_write;
  assign adc_period_hit = Adc && word == 10'h041;
  assign adc_period_write = adc_period_hit && write;
  always_ff @(posedge clk_i) begin
    if (adc_period_write) adc_period_o <= (adc_period_o & ~mask[23:0]) | (bus_data_i[23:0] & mask[23:0]);
    if (rst_i) adc_period_o <= 24'h0;
  end

  logic adc_dropped_hit;
  assign adc_dropped_hit = Adc && word == 10'h042;

  logic adc_overrun_hit;
  assign adc_overrun_hit = Adc && word == 10'h043;

  logic adc_timeout_hit;
  assign adc_timeout_hit = Adc && word == 10'h044;

  logic adc_over_range_hit;
  assign adc_over_range_hit = Adc && word == 10'h045;

  logic slip_threshold_hit, slip_threshold_write;
  assign slip_threshold_hit = Slip && word == 10'h080;
  assign slip_threshold_write = slip_threshold_hit && write;
  logic [19:0] slip_threshold_q;
  always_ff @(posedge clk_i) begin
    if (slip_threshold_write) slip_threshold_q <= (slip_threshold_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_threshold_q <= 20'hfffff;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_threshold_o <= slip_threshold_q;
    if (rst_i) slip_threshold_o <= 20'hfffff;
  end

  logic slip_gross_threshold_hit, slip_gross_threshold_write;
  assign slip_gross_threshold_hit = Slip && word == 10'h081;
  assign slip_gross_threshold_write = slip_gross_threshold_hit && write;
  logic [19:0] slip_gross_threshold_q;
  always_ff @(posedge clk_i) begin
    if (slip_gross_threshold_write) slip_gross_threshold_q <= (slip_gross_threshold_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_gross_threshold_q <= 20'hfffff;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_gross_threshold_o <= slip_gross_threshold_q;
    if (rst_i) slip_gross_threshold_o <= 20'hfffff;
  end

  logic slip_contact_level_hit, slip_contact_level_write;
  assign slip_contact_level_hit = Slip && word == 10'h082;
  assign slip_contact_level_write = slip_contact_level_hit && write;
  logic [19:0] slip_contact_level_q;
  always_ff @(posedge clk_i) begin
    if (slip_contact_level_write) slip_contact_level_q <= (slip_contact_level_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_contact_level_q <= 20'h0;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_contact_level_o <= slip_contact_level_q;
    if (rst_i) slip_contact_level_o <= 20'h0;
  end

  logic slip_release_level_hit, slip_release_level_write;
  assign slip_release_level_hit = Slip && word == 10'h083;
  assign slip_release_level_write = slip_release_level_hit && write;
  logic [19:0] slip_release_level_q;
  always_ff @(posedge clk_i) begin
    if (slip_release_level_write) slip_release_level_q <= (slip_release_level_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_release_level_q <= 20'h0;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_release_level_o <= slip_release_level_q;
    if (rst_i) slip_release_level_o <= 20'h0;
  end

  logic slip_contact_rises_hit, slip_contact_rises_write;
  assign slip_contact_rises_hit = Slip && word == 10'h084;
  assign slip_contact_rises_write = slip_contact_rises_hit && write;
  logic slip_contact_rises_q;
  always_ff @(posedge clk_i) begin
    if (slip_contact_rises_write) slip_contact_rises_q <= (slip_contact_rises_q & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) slip_contact_rises_q <= 1'h1;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_contact_rises_o <= slip_contact_rises_q;
    if (rst_i) slip_contact_rises_o <= 1'h1;
  end

  logic slip_hold_hit, slip_hold_write;
  assign slip_hold_hit = Slip && word == 10'h085;
  assign slip_hold_write = slip_hold_hit && write;
  logic [15:0] slip_hold_q;
  always_ff @(posedge clk_i) begin
    if (slip_hold_write) slip_hold_q <= (slip_hold_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) slip_hold_q <= 16'h0;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_hold_o <= slip_hold_q;
    if (rst_i) slip_hold_o <= 16'h0;
  end

  logic slip_refractory_hit, slip_refractory_write;
  assign slip_refractory_hit = Slip && word == 10'h086;
  assign slip_refractory_write = slip_refractory_hit && write;
  logic [15:0] slip_refractory_q;
  always_ff @(posedge clk_i) begin
    if (slip_refractory_write) slip_refractory_q <= (slip_refractory_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) slip_refractory_q <= 16'h0;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_refractory_o <= slip_refractory_q;
    if (rst_i) slip_refractory_o <= 16'h0;
  end

  logic slip_blank_hit, slip_blank_write;
  assign slip_blank_hit = Slip && word == 10'h087;
  assign slip_blank_write = slip_blank_hit && write;
  logic [15:0] slip_blank_q;
  always_ff @(posedge clk_i) begin
    if (slip_blank_write) slip_blank_q <= (slip_blank_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) slip_blank_q <= 16'h0;
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_blank_o <= slip_blank_q;
    if (rst_i) slip_blank_o <= 16'h0;
  end

  logic slip_damaged_hit;
  assign slip_damaged_hit = Slip && word == 10'h088;

  logic slip_blanked_hit;
  assign slip_blanked_hit = Slip && word == 10'h089;

  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_pending_o <= 1'b0;
    if (slip_threshold_write || slip_gross_threshold_write || slip_contact_level_write || slip_release_level_write || slip_contact_rises_write || slip_hold_write || slip_refractory_write || slip_blank_write) slip_pending_o <= 1'b1;
    if (rst_i) slip_pending_o <= 1'b0;
  end

  logic hit, writable;
  assign hit      = core_id_hit
      || core_version_hit
      || core_features_hit
      || core_size_hit
      || core_clk_khz_hit
      || core_scratch_hit
      || adc_enable_hit
      || adc_period_hit
      || adc_dropped_hit
      || adc_overrun_hit
      || adc_timeout_hit
      || adc_over_range_hit
      || slip_threshold_hit
      || slip_gross_threshold_hit
      || slip_contact_level_hit
      || slip_release_level_hit
      || slip_contact_rises_hit
      || slip_hold_hit
      || slip_refractory_hit
      || slip_blank_hit
      || slip_damaged_hit
      || slip_blanked_hit;
  assign writable = core_scratch_hit
      || adc_enable_hit
      || adc_period_hit
      || slip_threshold_hit
      || slip_gross_threshold_hit
      || slip_contact_level_hit
      || slip_release_level_hit
      || slip_contact_rises_hit
      || slip_hold_hit
      || slip_refractory_hit
      || slip_blank_hit;

  logic [31:0] read_word;
  assign read_word = ({32{core_id_hit}} & 32'h4d534e52)
      | ({32{core_version_hit}} & {16'h0, 8'h2, 8'h0})
      | ({32{core_features_hit}} & core_features_i)
      | ({32{core_size_hit}} & {core_size_columns_i, core_size_rows_i})
      | ({32{core_clk_khz_hit}} & core_clk_khz_i)
      | ({32{core_scratch_hit}} & core_scratch_o)
      | ({32{adc_enable_hit}} & {31'd0, adc_enable_o})
      | ({32{adc_period_hit}} & {8'd0, adc_period_o})
      | ({32{adc_dropped_hit}} & adc_dropped_i)
      | ({32{adc_overrun_hit}} & adc_overrun_i)
      | ({32{adc_timeout_hit}} & adc_timeout_i)
      | ({32{adc_over_range_hit}} & adc_over_range_i)
      | ({32{slip_threshold_hit}} & {12'd0, slip_threshold_q})
      | ({32{slip_gross_threshold_hit}} & {12'd0, slip_gross_threshold_q})
      | ({32{slip_contact_level_hit}} & {12'd0, slip_contact_level_q})
      | ({32{slip_release_level_hit}} & {12'd0, slip_release_level_q})
      | ({32{slip_contact_rises_hit}} & {31'd0, slip_contact_rises_q})
      | ({32{slip_hold_hit}} & {16'd0, slip_hold_q})
      | ({32{slip_refractory_hit}} & {16'd0, slip_refractory_q})
      | ({32{slip_blank_hit}} & {16'd0, slip_blank_q})
      | ({32{slip_damaged_hit}} & slip_damaged_i)
      | ({32{slip_blanked_hit}} & slip_blanked_i);

  always_ff @(posedge clk_i) begin
    bus_done_o  <= bus_valid_i;
    bus_error_o <= !hit || bus_address_i[1:0] != 2'd0 || (bus_write_i && !writable);
    bus_data_o  <= (bus_write_i || bus_address_i[1:0] != 2'd0) ? 32'd0 : read_word;
    if (rst_i) bus_done_o <= 1'b0;
  end

endmodule
