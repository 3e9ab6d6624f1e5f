function handles = plot_fit(varargin)
% mbk.plot_fit  Measured and predicted force, and the residual.
%
%   HANDLES = mbk.plot_fit(...) takes what mbk.measure takes, of one recording, measures it, and draws the force with
%   its prediction and what is left of it, on held-out data where there are any, as the report does. HANDLES are the
%   axes.
%
%   Example
%     mbk.plot_fit('log.mat', 'mode', 'reference')
%
%   See also mbk.measure, mbk.plot
  folder = tempname();
  mkdir(folder);
  page = fullfile(folder, 'report.html');
  cleaner = onCleanup(@() remove(folder, page));
  result = mbk.internal.run('measure', varargin, {'report', page});
  if ~strcmp(strtok(result.schema, '/'), 'mbk.result')
    error('mbk:usage', 'give one recording');
  end
  handles = mbk.internal.draw_fit(data_of(page), mbk.internal.unit_of(result, 'force'));
end

function report = data_of(page)
% What the page of a report shows, which stands in it as JSON.
  text = fileread(page);
  head = '<script type="application/json" id="report-data">';
  first = strfind(text, head);
  if isempty(first)
    error('mbk:data', 'this build of mbk has no page for reports; build it with npm');
  end
  text = text(first(1) + numel(head):end);
  last = strfind(text, '</script>');
  report = jsondecode(text(1:last(1) - 1));
end

function remove(folder, page)
  if exist(page, 'file') == 2
    delete(page);
  end
  rmdir(folder);
end
