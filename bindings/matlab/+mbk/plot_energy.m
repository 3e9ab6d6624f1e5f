function handles = plot_energy(result)
% mbk.plot_energy  What a result of mbk.measure says of energy.
%
%   HANDLES = mbk.plot_energy(RESULT) draws the least damping in any direction over frequency (the passivity index) with
%   its 95 % band: where it is below zero, the model can generate energy. Of what mbk.passivity found it draws the
%   energy that was absorbed over time as well. HANDLES are the axes.
%   See also mbk.plot, mbk.passivity
  handles = mbk.internal.draw_passivity(result);
end
