function handles = plot_energy(result)
% mbk.plot_energy  Passivity index of a result of mbk.measure.
%
%   HANDLES = mbk.plot_energy(RESULT) plots the passivity index (minimum damping in any direction) over frequency with
%   its 95 % band. Where it is below zero, the model can generate energy. For a result of mbk.passivity it also plots
%   the absorbed energy over time. HANDLES are the axes.
%   See also mbk.plot, mbk.passivity
  handles = mbk.internal.draw_passivity(result);
end
