// A functional cover point: hit in a clock in which EXPR holds. It is the toggle of a register, not a cover
// property, as of these Verilator adds up all that stand in one generate loop. A condition that holds for ever
// still toggles.
`define BIN(NAME, EXPR) logic bin_``NAME; always_ff @(posedge clk_i) bin_``NAME <= (EXPR) && !bin_``NAME;
