rtl/msn_pkg.sv
rtl/common/msn_sync.sv
rtl/frontend/msn_adc_pkg.sv
rtl/frontend/msn_spi_shift.sv
rtl/frontend/msn_adc_store.sv
rtl/frontend/msn_adc_spi.sv
