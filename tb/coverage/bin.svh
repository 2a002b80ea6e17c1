// A functional cover point: hit in a clock in which EXPR holds. It is the toggle of a register, not a cover property,
// because Verilator adds up all cover properties of a generate loop. A condition that always holds still toggles.
`define BIN(NAME, EXPR) logic bin_``NAME; always_ff @(posedge clk_i) bin_``NAME <= (EXPR) && !bin_``NAME;
