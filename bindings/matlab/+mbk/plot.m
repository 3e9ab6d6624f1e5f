function handles = plot(document)
% mbk.plot  Plot a result: ellipses and impedance, energy, or Bode plots.
%
%   HANDLES = mbk.plot(RESULT) plots the result of
%     mbk.measure, mbk.identify   two axes: ellipses of inertia, damping and stiffness, that is, the force (in N) for
%                                 one unit of acceleration, velocity or displacement in any direction, with the 95 %
%                                 interval of the orientation. One axis: M, B and K with their 95 % intervals. Below:
%                                 magnitude of M s^2 + B s + K along each axis over frequency
%     mbk.passivity               absorbed energy over time, and passivity index (minimum damping in any direction)
%                                 over frequency with its 95 % band
%     mbk.explore, mbk.tf         magnitude and phase (Bode) with their 95 % bands, and coherence
%   HANDLES are the axes.
%
%   If there are several results (RESULT.results), plot one: mbk.plot(RESULT.results{1}).
%   See also mbk.plot_energy, mbk.plot_fit
  schema = '';
  if isstruct(document) && isfield(document, 'schema')
    schema = strtok(document.schema, '/');
  end
  switch schema
    case 'mbk.result'
      handles = mbk.internal.draw_result(document);
    case 'mbk.passivity'
      handles = mbk.internal.draw_passivity(document);
    case {'mbk.explore', 'mbk.tf'}
      handles = mbk.internal.draw_responses(document);
    otherwise
      error('mbk:usage', ['this result has no plot; give a result of mbk.measure, identify, passivity, explore ' ...
                          'or tf for one recording']);
  end
end
