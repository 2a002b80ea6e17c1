rtl/msn_pkg.sv
rtl/common/msn_delay.sv
rtl/common/msn_frame_check.sv
rtl/slip/msn_haar.sv
rtl/slip/msn_sliding_extremes.sv
rtl/slip/msn_peak_to_peak.sv
rtl/slip/msn_slip.sv
rtl/msn_core.sv
