rtl/msn_pkg.sv
