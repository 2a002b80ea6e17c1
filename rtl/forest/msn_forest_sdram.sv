// SPDX-License-Identifier: Apache-2.0
//
// A forest whose nodes lie in an SDRAM, for one that no block RAM holds: msn_forest with one engine, and msn_sdram.
//
// Rows, results and loads are those of msn_forest; the address of a node is that of msn_sdram, and of Banks = 2 each half
// of a bank's rows holds a forest: bit 19 of the address is the half, so addresses there have it 0. Roots, leaves and the
// number of trees stay in block RAM. A row gets error 1 until a forest is in use, also while the SDRAM is set up.
// swap_i takes effect after the load under way.
//
// Latency: 4.1 clocks a node with 32 walkers at 100 MHz (docs/sdram.md).   Model: model/meissner/twins/forest/sdram.py

module msn_forest_sdram #(
  parameter  int unsigned Features    = 9,
  parameter  int unsigned FeatureBits = 22,
  parameter  int unsigned Classes     = 2,
  parameter  int unsigned Trees       = 512,
  parameter  int unsigned Leaves      = 256,
  parameter  int unsigned Banks       = 2,
  parameter  int unsigned Walkers     = 32,
  parameter  int unsigned ClkKhz      = 100_000,
  parameter  int unsigned PowerUpUs   = 200,
  parameter  int unsigned ReadClocks  = 4,
  localparam int unsigned ClassBits   = msn_pkg::index_width(Classes),
  localparam int unsigned TagBits     = msn_pkg::index_width(Walkers),
  localparam int unsigned ContextBits = 2
) (
  input  logic                   clk_i,
  input  logic                   rst_i,

  input  logic                   in_valid_i,
  output logic                   in_ready_o,
  input  logic [FeatureBits-1:0] in_data_i,
  input  logic                   in_last_i,
  output logic [31:0]            damaged_o,
  output logic [ContextBits-1:0] in_context_o,

  output logic                   out_valid_o,
  input  logic                   out_ready_i,
  output logic [ClassBits-1:0]   out_id_o,
  output logic [31:0]            out_votes_o,
  output logic                   out_last_o,
  output logic [ClassBits-1:0]   out_class_o,
  output logic [2:0]             out_error_o,
  output logic [ContextBits-1:0] out_context_o,
  output logic                   step_o,

  input  logic                   load_valid_i,
  output logic                   load_ready_o,
  input  logic [1:0]             load_kind_i,
  input  logic [31:0]            load_address_i,
  input  logic [63:0]            load_data_i,
  input  logic                   swap_i,
  output logic                   swapping_o,
  output logic                   up_o,

  output logic                   sdram_cke_o,
  output logic                   sdram_cs_n_o,
  output logic                   sdram_ras_n_o,
  output logic                   sdram_cas_n_o,
  output logic                   sdram_we_n_o,
  output logic [1:0]             sdram_ba_o,
  output logic [12:0]            sdram_a_o,
  output logic [1:0]             sdram_dqm_o,
  output logic [15:0]            sdram_dq_o,
  output logic                   sdram_dq_enable_o,
  input  logic [15:0]            sdram_dq_i
);

  // A node goes to the SDRAM. The forest sees every load too: with one bank its first one ends the decisions.
  logic is_node, forest_ready, sdram_valid, sdram_ready, begun, swap, swap_waits, swapping;
  assign is_node      = load_kind_i == 2'd0;
  assign sdram_valid  = load_valid_i && is_node && (forest_ready || begun);
  assign load_ready_o = is_node ? sdram_ready && sdram_valid : forest_ready;
  assign swap         = (swap_i || swap_waits) && !sdram_valid;
  assign swapping_o   = swapping || swap_waits;
  always_ff @(posedge clk_i) begin
    begun      <= sdram_valid && !sdram_ready;
    swap_waits <= (swap_i || swap_waits) && !swap;
    if (rst_i) {begun, swap_waits} <= '0;
  end

  logic               req_valid, req_ready, req_bank, rsp_valid;
  logic [21:0]        req_address, sdram_address, load_address;
  logic [TagBits-1:0] req_tag, rsp_tag;
  logic [63:0]        rsp_data;
  assign sdram_address = {req_address[21:20], Banks == 2 ? req_bank : req_address[19], req_address[18:0]};
  assign load_address  = {load_address_i[21:20], Banks == 2 ? !req_bank : load_address_i[19],
                          load_address_i[18:0]};

  msn_forest #(
    .Features(Features), .FeatureBits(FeatureBits), .Classes(Classes), .Trees(Trees), .Nodes(2 ** 22),
    .Leaves(Leaves), .Engines(1), .Banks(Banks), .Walkers(Walkers), .Contexts(2 ** ContextBits),
    .Outside(1'b1)
  ) u_forest (
    .clk_i, .rst_i,
    .in_valid_i, .in_ready_o, .in_data_i, .in_last_i, .damaged_o, .in_context_o,
    .out_valid_o, .out_ready_i, .out_id_o, .out_votes_o, .out_last_o, .out_class_o, .out_error_o,
    .out_context_o, .step_o,
    .load_valid_i, .load_ready_o(forest_ready), .load_kind_i, .load_engine_i(1'b0), .load_address_i,
    .load_data_i,
    .swap_i(swap), .swapping_o(swapping),
    .req_valid_o(req_valid), .req_ready_i(req_ready), .req_bank_o(req_bank), .req_address_o(req_address),
    .req_tag_o(req_tag), .rsp_valid_i(rsp_valid), .rsp_tag_i(rsp_tag), .rsp_data_i(rsp_data)
  );

  msn_sdram #(
    .ClkKhz(ClkKhz), .PowerUpUs(PowerUpUs), .TagBits(TagBits), .Queue(2 ** TagBits), .ReadClocks(ReadClocks)
  ) u_sdram (
    .clk_i, .rst_i,
    .req_valid_i(req_valid), .req_ready_o(req_ready), .req_address_i(sdram_address), .req_tag_i(req_tag),
    .rsp_valid_o(rsp_valid), .rsp_tag_o(rsp_tag), .rsp_data_o(rsp_data),
    .load_valid_i(sdram_valid), .load_ready_o(sdram_ready), .load_address_i(load_address), .load_data_i,
    .up_o,
    .sdram_cke_o, .sdram_cs_n_o, .sdram_ras_n_o, .sdram_cas_n_o, .sdram_we_n_o, .sdram_ba_o, .sdram_a_o,
    .sdram_dqm_o, .sdram_dq_o, .sdram_dq_enable_o, .sdram_dq_i
  );

endmodule
