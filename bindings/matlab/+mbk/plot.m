function handles = plot(document)
% mbk.plot  What a result shows: ellipses and impedance, energy, Bode plots.
%
%   HANDLES = mbk.plot(RESULT) draws what was found by
%     mbk.measure, mbk.identify   with two axes the ellipses of inertia, damping and stiffness, each the force (in N)
%                                 that one unit of acceleration, velocity or displacement in any direction takes, with
%                                 the 95 % interval of its direction; with one axis M, B and K with their 95 % intervals.
%                                 Below: the magnitude of M s^2 + B s + K along each axis over frequency
%     mbk.passivity               the energy that was absorbed, and the least damping in any direction over frequency
%                                 (the passivity index) with its 95 % band
%     mbk.explore, mbk.tf         magnitude and phase with their 95 % bands (Bode), and the coherence
%   HANDLES are the axes.
%
%   Of several results (RESULT.results), draw one: mbk.plot(RESULT.results{1}).
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
      error('mbk:usage', ['there is no plot of this: give what mbk.measure, identify, passivity, explore or tf found ' ...
                          'of one recording']);
  end
end
